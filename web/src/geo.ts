/**
 * Places on the earth by the tangent plane at an origin, WGS 84, as the program has them (isobath/geometry/geodesy.hpp):
 * the point on the water straight below or above (north, east) of the plane. Exact; beyond 1000 km it means nothing.
 */
const kA = 6378137;
const kFlattening = 1 / 298.257223563;
const kE2 = kFlattening * (2 - kFlattening);
const kDegree = Math.PI / 180;

export interface GeoPlace {
  latitude: number;
  longitude: number;
}

/** Degrees, of a place north and east of the origin, m. */
export function geoPlace(origin: GeoPlace, north: number, east: number): GeoPlace {
  const [s, c] = [Math.sin(origin.latitude * kDegree), Math.cos(origin.latitude * kDegree)];
  const prime = kA / Math.sqrt(1 - kE2 * s * s);
  // In the plane of the origin's meridian: x outwards, y east, z along the axis of the earth; up is (c, 0, s).
  const [x, y, z] = [prime * c - north * s, east, prime * (1 - kE2) * s + north * c];
  // u up of the plane, the surface is met: x2 + y2 + z2 / (1 - e2) = a2 is a quadratic in u.
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
