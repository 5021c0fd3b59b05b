/** Places on the earth near an origin, WGS 84: a plane that touches there, good to centimetres within some kilometres. */
const kA = 6378137;
const kE2 = 6.69437999014e-3;
const kDegree = Math.PI / 180;

export interface GeoPlace {
  latitude: number;
  longitude: number;
}

/** Degrees, of a place north and east of the origin, m. */
export function geoPlace(origin: GeoPlace, north: number, east: number): GeoPlace {
  const s = Math.sin(origin.latitude * kDegree);
  const c = Math.cos(origin.latitude * kDegree);
  const w = 1 - kE2 * s * s;
  const prime = kA / Math.sqrt(w);
  const meridian = (prime * (1 - kE2)) / w;
  return {
    latitude: origin.latitude + north / meridian / kDegree,
    longitude: origin.longitude + east / (prime * c) / kDegree,
  };
}
