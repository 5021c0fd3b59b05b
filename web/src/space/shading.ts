/**
 * Light from above and ambient light, computed per vertex instead of per pixel: without a graphics processor, shading
 * takes most of the time of a picture. Colours are those of the screen, 0 to 1.
 */
import { Vector2, Vector3 } from 'three';

/** Towards the sun: east, north, up. */
export const kSunward = new Vector3(-0.5, 0.6, 1).normalize();
/** Intensities of the ambient light and of the sun, as in three.js. */
export const [kDaylight, kNightlight] = [new Vector2(1.7, 2), new Vector2(1.1, 1.6)];
/** The present light of the scene. */
export const kLight = kDaylight.clone();

export const lightUniforms = (opacity = 1) => ({
  light: { value: kLight },
  sunward: { value: kSunward },
  opacity: { value: opacity },
});

/** For models that are stretched but not rotated. */
export const shadeInVertex = `
uniform vec2 light;
uniform vec3 sunward;
varying vec3 shown;
void shade(vec3 tint, vec3 normal) {
  vec3 stretch = vec3(modelMatrix[0][0], modelMatrix[1][1], modelMatrix[2][2]);
  float facing = max(0.0, dot(normalize(normal / stretch), sunward));
  shown = min(vec3(1.0), tint * pow((light.x + light.y * facing) / 3.14159, 1.0 / 2.2));
}
`;
export const shadedFragment = `
uniform float opacity;
varying vec3 shown;
void main() { gl_FragColor = vec4(shown, opacity); }
`;
