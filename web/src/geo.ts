/**
 * Geographic positions from the tangent plane at an origin, WGS 84, as in isobath/geometry/geodesy.hpp: the point of
 * the ellipsoid straight below or above (north, east) of the plane. Exact; not meaningful beyond 1000 km.
 */
const kA = 6378137;
const kFlattening = 1 / 298.257223563;
const kE2 = kFlattening * (2 - kFlattening);
const kDegree = Math.PI / 180;

export interface GeoPlace {
  latitude: number;
  longitude: number;
}

/** Latitude and longitude, degrees, of a position in metres north and east of the origin. */
export function geoPlace(origin: GeoPlace, north: number, east: number): GeoPlace {
  const [s, c] = [Math.sin(origin.latitude * kDegree), Math.cos(origin.latitude * kDegree)];
  const prime = kA / Math.sqrt(1 - kE2 * s * s);
  // Relative to the plane of the origin's meridian: x outwards, y east, z along the earth's axis; up is (c, 0, s).
  const [x, y, z] = [prime * c - north * s, east, prime * (1 - kE2) * s + north * c];
  // The ellipsoid is met at height u above the plane: x2 + y2 + z2 / (1 - e2) = a2 is a quadratic in u.
  const p = c * c + (s * s) / (1 - kE2);
  const q = x * c + (z * s) / (1 - kE2);
  const r = x * x + y * y + (z * z) / (1 - kE2) - kA * kA;
  const u = -r / (q + Math.sqrt(Math.max(0, q * q - p * r)));
  const [out, up] = [x + u * c, z + u * s];
  const longitude = origin.longitude + Math.atan2(y, out) / kDegree;
  return {
    latitude: Math.atan2(up, (1 - kE2) * Math.hypot(out, y)) / kDegree,
    longitude: longitude > 180 ? longitude - 360 : longitude < -180 ? longitude + 360 : longitude,
  };
}
