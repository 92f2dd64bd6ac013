// Programs of the graphics card. Colours of Gaussians are display values (sRGB) of the view; they are blended as light,
// as the model does: the target of the first pass stores sRGB and blends what it stands for.
const CAMERA = `#version 300 es
precision highp float;
precision highp int;
uniform vec3 uEye;
uniform mat3 uCam;  // columns: right, down, forward
uniform vec2 uSize; // of the target, pixels
uniform float uFocal;
vec3 seen(vec3 place) { return (place - uEye) * uCam; }
vec4 onScreen(vec3 p) {
  const float near = 0.05;
  return vec4(2.0 * uFocal * p.x / uSize.x, -2.0 * uFocal * p.y / uSize.y, p.z - 2.0 * near, p.z);
}
`;

const LIGHT = `
vec3 light(vec3 display) {
  vec3 c = clamp(display, 0.0, 1.0);
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));
}
`;

// Colours of Gaussians as the eye sees them, one pixel each: display values with the panes' tints, and opacity.
const COLOUR_FRAGMENT = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;
uniform usampler2D uData;
uniform usampler2D uRest;
uniform sampler2D uTints; // by pane + 1
uniform vec3 uEye;
uniform int uDegree;
uniform float uSteps[15];
uniform vec2 uRange;
out vec4 found;

uvec4 texels[3];
float signedByte(int at) {
  int word = int(texels[at >> 4][(at >> 2) & 3]);
  return float((word << (24 - 8 * (at & 3))) >> 24);
}
vec3 coefficient(int k) {
  return vec3(signedByte(3 * k), signedByte(3 * k + 1), signedByte(3 * k + 2)) * uSteps[k];
}

vec3 ofDirection(vec3 d) {
  float x = d.x, y = d.y, z = d.z;
  vec3 c = 0.4886025 * (-y * coefficient(0) + z * coefficient(1) - x * coefficient(2));
  if (uDegree < 2) return c;
  float xx = x * x, yy = y * y, zz = z * z;
  c += 1.0925484 * (x * y * coefficient(3) - y * z * coefficient(4) - x * z * coefficient(6))
    + 0.3153916 * (3.0 * zz - 1.0) * coefficient(5) + 0.5462742 * (xx - yy) * coefficient(7);
  if (uDegree < 3) return c;
  return c - 0.5900436 * (y * (3.0 * xx - yy) * coefficient(8) + x * (xx - 3.0 * yy) * coefficient(14))
    + 2.8906114 * x * y * z * coefficient(9) + 1.4453057 * z * (xx - yy) * coefficient(13)
    - 0.4570458 * (5.0 * zz - 1.0) * (y * coefficient(10) + x * coefficient(12))
    + 0.3731763 * z * (5.0 * zz - 3.0) * coefficient(11);
}

void main() {
  ivec2 cell = ivec2(gl_FragCoord.xy);
  uvec4 a = texelFetch(uData, ivec2(2 * cell.x, cell.y), 0);
  uvec4 b = texelFetch(uData, ivec2(2 * cell.x + 1, cell.y), 0);
  vec3 colour = uRange.x + (uRange.y - uRange.x) * vec3(uvec3(b.w, b.w >> 8, b.w >> 16) & 255u) / 255.0;
  if (uDegree > 0) {
    for (int i = 0; i < uDegree; i++) texels[i] = texelFetch(uRest, ivec2(cell.x * uDegree + i, cell.y), 0);
    vec3 towards = uintBitsToFloat(a.xyz) - uEye;
    colour += ofDirection(towards / max(length(towards), 1e-6));
  }
  colour = clamp(colour, 0.0, 1.0);
  int pane = int(b.z >> 16);
  vec4 tint = texelFetch(uTints, ivec2(pane & 255, pane >> 8), 0);
  float grey = dot(colour, vec3(0.3, 0.59, 0.11));
  found = vec4(mix(colour, tint.rgb * (0.65 + 0.5 * grey), tint.a), float(b.w >> 24) / 255.0);
}`;

// Discs as a ray meets them (Huang et al., 2024), blurred as `reconstruction.splats.rasterising.projection` does it; ellipsoids
// projected to ellipses (Zwicker et al., 2001; Kerbl et al., 2023). Both with the low-pass they were learned with.
const SPLAT_VERTEX = `${CAMERA}${LIGHT}
precision highp usampler2D;
uniform usampler2D uData;
uniform sampler2D uColours;
uniform float uBlur;      // its variance, square pixels
uniform bool uAntialiased; // what the low-pass makes larger is as much more transparent (Yu et al., 2024)
uniform float uBefore;    // above 0: of what lies on no pane and before this depth, how much it hides
layout(location = 0) in uint aIndex;
flat out vec4 vColour;
out vec2 vPlace;          // in standard deviations

const float FLAT = 4e-6;  // metres: what is thinner is a disc

vec3 axes[3];
void setAxes(vec4 q) {
  float w = q.x, x = q.y, y = q.z, z = q.w;
  axes[0] = vec3(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y));
  axes[1] = vec3(2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x));
  axes[2] = vec3(2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y));
}

// How a place in standard deviations moves on the screen, and the relative change of the depth with it.
mat2 onto = mat2(0.0);
vec2 slopes = vec2(0.0);
float share = 1.0; // of the opacity that the low-pass leaves

void setDisc(vec3 p, vec3 u, vec3 v) {
  vec2 q = vec2(u.z, v.z) / p.z;
  vec2 ju = uFocal * (u.xy - p.xy * q.x) / p.z, jv = uFocal * (v.xy - p.xy * q.y) / p.z;
  float area = ju.x * jv.y - jv.x * ju.y;
  float square = area * area + uBlur * (dot(ju, ju) + dot(jv, jv) + uBlur);
  float xx = ju.x * ju.x + jv.x * jv.x + uBlur;
  float xy = ju.x * ju.y + jv.x * jv.y;
  float yy = ju.y * ju.y + jv.y * jv.y + uBlur;
  vec2 along = ju * q.x + jv * q.y;
  vec2 likely = vec2(xy * along.y - yy * along.x, xy * along.x - xx * along.y) / square;
  vec2 plane = vec2(ju.y * q.y - jv.y * q.x, jv.x * q.x - ju.x * q.y);
  const float tiny = 1e-18;
  float steepest = 5.6712818 / uFocal; // of a plane at 80 degrees
  float limit = steepest * steepest, steep = dot(plane, plane);
  float over = limit * area * area >= steep && abs(area) > tiny ? 1.0 / area : limit * area / max(steep, tiny);
  vec2 tilt = (1.0 - over * area) * likely + over * plane;
  float right = sqrt(xx), beside = xy / right, lower = sqrt(square) / right;
  onto = mat2(right, beside, 0.0, lower);
  slopes = -vec2(right * tilt.x + beside * tilt.y, lower * tilt.y);
  share = abs(area) / sqrt(square);
}

void setEllipsoid(vec3 p, vec3 sizes) {
  vec2 limit = 1.3 * 0.5 * uSize / uFocal;
  vec2 tangent = clamp(p.xy / p.z, -limit, limit);
  mat2 spread = mat2(0.0);
  for (int i = 0; i < 3; i++) {
    vec3 c = sizes[i] * (axes[i] * uCam);
    vec2 t = uFocal / p.z * (c.xy - tangent * c.z);
    spread += outerProduct(t, t);
  }
  float sharp = determinant(spread);
  spread += mat2(uBlur, 0.0, 0.0, uBlur);
  share = sqrt(clamp(sharp / determinant(spread), 0.0, 1.0));
  float middle = 0.5 * (spread[0][0] + spread[1][1]);
  float half_ = 0.5 * (spread[0][0] - spread[1][1]);
  float far = sqrt(half_ * half_ + spread[0][1] * spread[0][1]);
  float angle = 0.5 * atan(spread[0][1], far < 1e-6 ? 1.0 : half_);
  vec2 long_ = vec2(cos(angle), sin(angle));
  vec2 lengths = sqrt(vec2(middle + far, max(middle - far, 0.5 * uBlur)));
  onto = mat2(lengths.x * long_, lengths.y * vec2(-long_.y, long_.x));
}

void main() {
  gl_Position = vec4(0.0, 0.0, 2.0, 1.0); // outside: not drawn
  int index = int(aIndex);
  ivec2 cell = ivec2(index & 1023, index >> 10);
  uvec4 a = texelFetch(uData, ivec2(2 * cell.x, cell.y), 0);
  vec3 mean = uintBitsToFloat(a.xyz);
  vec3 p = seen(mean);
  if (p.z < 0.2) return;
  uvec4 b = texelFetch(uData, ivec2(2 * cell.x + 1, cell.y), 0);
  int pane = int(b.z >> 16);
  if (uBefore > 0.0 && (pane > 0 || p.z > uBefore)) return;
  float opacity = float(b.w >> 24) / 255.0;
  if (opacity < 1.0 / 255.0) return;

  vec4 q = vec4(unpackHalf2x16(a.w), unpackHalf2x16(b.x));
  setAxes(q / max(length(q), 1e-6));
  vec3 sizes = vec3(unpackHalf2x16(b.y), unpackHalf2x16(b.z & 0xffffu).x);
  if (sizes.z < FLAT) {
    setDisc(p, sizes.x * (axes[0] * uCam), sizes.y * (axes[1] * uCam));
  } else {
    float largest = 3.4 * (uFocal / p.z * max(sizes.x, max(sizes.y, sizes.z)) * (1.0 + length(0.65 * uSize / uFocal)) + 1.0);
    if (any(greaterThan(abs(uFocal * p.xy / p.z), 0.5 * uSize + largest))) return;
    setEllipsoid(p, sizes);
  }
  if (uAntialiased) opacity = min(opacity, max(opacity * share, 2.0 / 255.0)); // small ones do not vanish from afar
  float reach = sqrt(2.0 * log(255.0 * opacity));
  vPlace = (vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0) * reach;
  // In one plane, so that what lies between the corners is where a ray meets it.
  float depth = 1.0 + dot(slopes, vPlace);
  vec2 at = uFocal * p.xy / p.z * depth + onto * vPlace;
  const float near = 0.1;
  gl_Position = vec4(2.0 * at.x / uSize.x, -2.0 * at.y / uSize.y, depth - 2.0 * near / p.z, depth);

  vColour = vec4(light(texelFetch(uColours, cell, 0).rgb), opacity);
}`;

const SPLAT_FRAGMENT = `#version 300 es
precision highp float;
flat in vec4 vColour;
in vec2 vPlace;
out vec4 colour;
void main() {
  float alpha = min(0.99, vColour.a * exp(-0.5 * dot(vPlace, vPlace)));
  if (alpha < 1.0 / 255.0) discard;
  colour = vec4(vColour.rgb * alpha, alpha);
}`;

const PANE_VERTEX = `${CAMERA}
uniform sampler2D uTints;
layout(location = 0) in vec3 aPlace;
layout(location = 1) in float aPane; // its number + 1; below 0 where Gaussians show it
out vec4 vTint;
void main() {
  int pane = int(max(aPane, 0.0));
  vec4 tint = texelFetch(uTints, ivec2(pane & 255, pane >> 8), 0);
  vTint = pane > 0 ? (tint.a > 0.0 ? vec4(tint.rgb, 0.75) : vec4(0.5, 0.6, 0.7, 0.35)) : vec4(0.0);
  gl_Position = onScreen(seen(aPlace));
}`;

const UI_FRAGMENT_HEAD = `#version 300 es
precision highp float;
out vec4 colour;
${LIGHT}
`;

const PANE_FRAGMENT = `${UI_FRAGMENT_HEAD}
in vec4 vTint;
void main() { colour = vec4(light(vTint.rgb) * vTint.a, vTint.a); }`;

// Thick lines: an instance for each edge.
const LINE_VERTEX = `${CAMERA}
uniform float uWidth;
layout(location = 0) in vec3 aFrom;
layout(location = 1) in vec3 aTo;
out float vAcross;
void main() {
  vec3 a = seen(aFrom), b = seen(aTo);
  const float near = 0.06;
  gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
  vAcross = 0.0;
  if (a.z < near && b.z < near) return;
  if (a.z < near) a = mix(b, a, (b.z - near) / (b.z - a.z));
  if (b.z < near) b = mix(a, b, (a.z - near) / (a.z - b.z));
  vec2 u = a.xy / a.z * uFocal, v = b.xy / b.z * uFocal;
  vec2 d = normalize(v - u + vec2(1e-6, 0.0));
  vAcross = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
  float half_ = 0.5 * uWidth + 1.0;
  vec2 at = (gl_VertexID >> 1) == 0 ? u - d * 0.5 * uWidth : v + d * 0.5 * uWidth;
  at += vAcross * half_ * vec2(-d.y, d.x);
  vAcross *= half_;
  gl_Position = vec4(2.0 * at.x / uSize.x, -2.0 * at.y / uSize.y, 0.0, 1.0);
}`;

const LINE_FRAGMENT = `${UI_FRAGMENT_HEAD}
uniform float uWidth;
uniform vec4 uColour;
in float vAcross;
void main() {
  float alpha = uColour.a * clamp(0.5 * uWidth + 0.5 - abs(vAcross), 0.0, 1.0);
  colour = vec4(light(uColour.rgb) * alpha, alpha);
}`;

const MARK_VERTEX = `${CAMERA}
uniform float uWidth;
layout(location = 0) in vec3 aPlace;
layout(location = 1) in vec3 aNormal;
layout(location = 2) in vec4 aColour; // alpha 0: hollow
out vec4 vColour;
void main() {
  vColour = aColour;
  float side = dot(uEye - aPlace, aNormal);
  vec3 p = seen(aPlace);
  gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
  if (side > 0.0 && p.z > 0.1) {
    gl_Position = onScreen(p);
    vec4 before = onScreen(p * 0.97 - vec3(0.0, 0.0, 0.05)); // its own pane must not cut it
    gl_Position.z = before.z / max(before.w, 0.01) * gl_Position.w;
  }
  gl_PointSize = uWidth;
}`;

const MARK_FRAGMENT = `${UI_FRAGMENT_HEAD}
uniform float uWidth;
in vec4 vColour;
void main() {
  float r = length(gl_PointCoord - 0.5) * uWidth;
  float alpha = clamp(0.5 * uWidth - r, 0.0, 1.0);
  float inside = clamp(0.5 * uWidth - 2.0 - r, 0.0, 1.0);
  vec3 dark = vec3(0.08);
  vec3 middle = vColour.a > 0.5 ? vColour.rgb : mix(vec3(1.0), vColour.rgb, clamp(r - 0.5 * uWidth + 5.0, 0.0, 1.0));
  vec3 ring = mix(vec3(1.0), dark, clamp(r - 0.5 * uWidth + 1.5, 0.0, 1.0) * 0.6);
  colour = vec4(light(mix(ring, middle, inside)) * alpha, alpha);
}`;

// The light that was blended, over the background, as display values.
const SHOW_VERTEX = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;

// Where a picture of all directions shows one, as `reconstruction.splats.sky` reads it: rows from the zenith to the
// nadir, columns clockwise from south, so that north is in the middle. A unit direction: east, north, up.
const SKY_PLACE = `
vec2 skyPlace(vec3 d) {
  float north = abs(d.x) + abs(d.y) > 1e-6 ? d.y : 1.0;
  return vec2(0.5 + atan(d.x, north) / 6.2831853, 0.5 - asin(clamp(d.z, -1.0, 1.0)) / 3.1415927);
}
`;

const SHOW_FRAGMENT = `${UI_FRAGMENT_HEAD}${SKY_PLACE}
uniform sampler2D uLight;
uniform highp sampler2D uSky; // linear light
uniform vec2 uSize;
uniform float uFocal;
uniform mat3 uCam;
void main() {
  vec4 found = texelFetch(uLight, ivec2(gl_FragCoord.xy), 0);
  vec3 d = normalize(uCam * vec3((gl_FragCoord.xy - 0.5 * uSize) * vec2(1.0, -1.0) / uFocal, 1.0));
  vec3 behind = textureLod(uSky, skyPlace(d), 0.0).rgb;
  vec3 c = clamp(found.rgb + (1.0 - found.a) * behind, 0.0, 1.0);
  colour = vec4(mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)), 1.0);
}`;
