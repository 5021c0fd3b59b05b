/** Numbers as mariners read them, each with its unit. An unknown value is an en dash, never a zero. */
const kUnknown = '–';
const kDegree = Math.PI / 180;
/** s since 1970: ten years */
const kFirstDate = 315_619_200;

/** A true minus, and no "-0.0". */
function fixed(value: number, digits: number): string {
  const text = Math.abs(value).toFixed(digits);
  return value < 0 && Number(text) !== 0 ? `−${text}` : text;
}
const known = (value: number | undefined | null): value is number =>
  value !== undefined && value !== null && Number.isFinite(value);

export function metres(value: number | undefined | null, digits = 1): string {
  if (!known(value)) return `${kUnknown} m`;
  if (Math.abs(value) >= 10000) return `${fixed(value / 1000, 1)} km`;
  return `${fixed(value, digits)} m`;
}
/** A round distance without the digits that it does not need: "0.5 m", "20 m", "2 km". */
export function roundMetres(value: number): string {
  return value >= 1000 ? `${value / 1000} km` : `${value} m`;
}
export function speed(value: number | undefined | null): string {
  return known(value) ? `${fixed(value, 2)} m/s` : `${kUnknown} m/s`;
}
/** 0..360, three figures: "047°". */
export function bearing(radians: number | undefined | null): string {
  if (!known(radians)) return `${kUnknown}°`;
  const whole = ((Math.round(radians / kDegree) % 360) + 360) % 360;
  return `${String(whole).padStart(3, '0')}°`;
}
/** "12° to starboard". */
export function relativeBearing(degrees: number | undefined | null): string {
  if (!known(degrees)) return `${kUnknown}°`;
  const d = ((((degrees + 180) % 360) + 360) % 360) - 180;
  const whole = Math.round(Math.abs(d));
  if (whole === 0) return 'ahead';
  if (whole === 180) return 'astern';
  return `${whole}° to ${d > 0 ? 'starboard' : 'port'}`;
}
/** The same in short: "30° stb". */
export function fromBow(degrees: number): string {
  return relativeBearing(degrees).replace('to starboard', 'stb').replace('to port', 'port');
}
/** Elevation of a beam above the horizon: "12° up", "3° down", "level". */
export function elevation(radians: number | undefined | null): string {
  if (!known(radians)) return `${kUnknown}°`;
  const whole = Math.round(Math.abs(radians) / kDegree);
  return whole === 0 ? 'level' : `${whole}° ${radians > 0 ? 'up' : 'down'}`;
}
export function tilt(radians: number | undefined | null): string {
  return known(radians) ? `${fixed(radians / kDegree, 1)}°` : `${kUnknown}°`;
}
/** Roll and pitch: "3° stb, 2° up". */
export function attitude(roll: number | undefined | null, pitch: number | undefined | null): string {
  if (!known(roll) || !known(pitch)) return `${kUnknown}°`;
  const side = Math.round(roll / kDegree);
  const heel = side === 0 ? 'even' : `${Math.abs(side)}° ${side > 0 ? 'stb' : 'port'}`;
  return `${heel}, ${elevation(pitch)}`;
}
export function percent(share: number | undefined | null): string {
  return known(share) ? `${fixed(share * 100, 0)} %` : `${kUnknown} %`;
}
/** 52°20.2501′ N */
export function latitude(degrees: number): string {
  return `${minutes(degrees, 2)} ${degrees < 0 ? 'S' : 'N'}`;
}
export function longitude(degrees: number): string {
  return `${minutes(degrees, 3)} ${degrees < 0 ? 'W' : 'E'}`;
}
function minutes(degrees: number, figures: number): string {
  const units = Math.round(Math.abs(degrees) * 600000);
  const whole = Math.floor(units / 600000);
  return `${String(whole).padStart(figures, '0')}°${((units % 600000) / 10000).toFixed(4).padStart(7, '0')}′`;
}
/** Time since the start: "1:02:03.4", "2:03.4". */
export function elapsed(seconds: number | undefined | null, digits = 1): string {
  if (!known(seconds)) return kUnknown;
  const scale = 10 ** digits;
  const units = Math.round(Math.abs(seconds) * scale);
  const sign = seconds < 0 && units > 0 ? '−' : '';
  const s = (units / scale) % 60;
  const m = Math.floor(units / scale / 60) % 60;
  const h = Math.floor(units / scale / 3600);
  const tail = s.toFixed(digits).padStart(digits > 0 ? 3 + digits : 2, '0');
  return h > 0 ? `${sign}${h}:${String(m).padStart(2, '0')}:${tail}` : `${sign}${m}:${tail}`;
}
/** 2026-05-01 10:00:04 UTC; empty for a run without a date, whose times are in the first ten years of the epoch. */
export function utc(secondsSince1970: number): string {
  if (secondsSince1970 < kFirstDate) return '';
  const date = new Date(secondsSince1970 * 1000);
  if (!known(secondsSince1970) || Number.isNaN(date.getTime())) return kUnknown;
  return `${date.toISOString().slice(0, 19).replace('T', ' ')} UTC`;
}
export function rate(bytesPerSecond: number): string {
  if (bytesPerSecond >= 1e6) return `${(bytesPerSecond / 1e6).toFixed(1)} MB/s`;
  if (bytesPerSecond >= 1e3) return `${(bytesPerSecond / 1e3).toFixed(0)} kB/s`;
  return `${bytesPerSecond.toFixed(0)} B/s`;
}
export function count(value: number): string {
  return value.toLocaleString('en-GB');
}
export function milliseconds(value: number): string {
  if (!known(value)) return `${kUnknown} ms`;
  return `${value >= 100 ? value.toFixed(0) : value >= 10 ? value.toFixed(1) : value.toFixed(2)} ms`;
}
/** An age: "0.4 s", "12 s", "3 min". */
export function age(seconds: number): string {
  if (!known(seconds)) return kUnknown;
  if (seconds < 10) return `${Math.max(0, seconds).toFixed(1)} s`;
  return seconds < 120 ? `${seconds.toFixed(0)} s` : `${(seconds / 60).toFixed(0)} min`;
}
/** The next 1, 2 or 5 times a power of ten. */
export function roundStep(least: number): number {
  if (!(least > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(least) + 1e-9);
  return ([1, 2, 5].find((m) => m * power >= least * (1 - 1e-9)) ?? 10) * power;
}
