// Vectors, matrices (lists of rows) and the interpolation of attitudes between the frames of a motion.

export const times = (M, v) => M.map(row => row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
export const column = (M, k) => [M[0][k], M[1][k], M[2][k]];
export const scaled = (v, by) => v.map(x => by * x);

/** Return the matrix product of A and B. */
export const product = (A, B) => A.map(row => [0, 1, 2].map(k => row[0] * B[0][k] + row[1] * B[1][k] + row[2] * B[2][k]));

/** Return the transpose, which is the inverse of a rotation. */
export const transposed = M => [0, 1, 2].map(k => column(M, k));

/** Return the rotation matrix of a quaternion (w, x, y, z), which need not be normalized. */
export function matrix([w, x, y, z]) {
  const s = 2 / (w * w + x * x + y * y + z * z);
  return [[1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
    [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
    [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)]];
}

/** Return the angle between two attitudes, rotation matrices, in degrees. */
export function angleBetween(A, B) {
  const norm = Math.hypot(...A.flatMap((row, i) => row.map((x, j) => x - B[i][j])));
  return 360 / Math.PI * Math.asin(Math.min(norm / Math.sqrt(8), 1));
}

/** Interpolate the attitude at a time. q holds one quaternion after another, for the times t. Return null after the last quaternion. */
export function attitude(t, q, time) {
  const many = q.length / 4, after = t.findIndex(one => one > time), k = after < 0 ? t.length - 1 : after - 1;
  if (k >= many) return null;
  const next = Math.min(k + 1, many - 1), part = next > k ? (time - t[k]) / (t[next] - t[k]) : 0;
  return matrix([0, 1, 2, 3].map(i => (1 - part) * q[4 * k + i] + part * q[4 * next + i]));
}

/** Return the rotation that takes a unit vector to the third axis. */
export const rotationToZ = ([x, y, z]) => (z < -0.999999
  ? [[1, 0, 0], [0, -1, 0], [0, 0, -1]]
  : [[1 - x * x / (1 + z), -x * y / (1 + z), -x], [-x * y / (1 + z), 1 - y * y / (1 + z), -y], [x, y, z]]);
