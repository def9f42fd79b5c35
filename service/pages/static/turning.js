// Vectors, matrices as rows, and attitudes between the frames of a motion.

export const times = (M, v) => M.map(row => row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
export const column = (M, k) => [M[0][k], M[1][k], M[2][k]];
export const longer = (v, by) => v.map(x => by * x);

/** The matrix product of A and B. */
export const product = (A, B) => A.map(row => [0, 1, 2].map(k => row[0] * B[0][k] + row[1] * B[1][k] + row[2] * B[2][k]));

/** The same rotation the other way. */
export const transposed = M => [0, 1, 2].map(k => column(M, k));

/** The rotation matrix of a quaternion of any length. */
export function matrix([w, x, y, z]) {
  const s = 2 / (w * w + x * x + y * y + z * z);
  return [[1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
    [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
    [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)]];
}

/** The angle between two attitudes in degrees. */
export function apart(A, B) {
  const norm = Math.hypot(...A.flatMap((row, i) => row.map((x, j) => x - B[i][j])));
  return 360 / Math.PI * Math.asin(Math.min(norm / Math.sqrt(8), 1));
}

/** The attitude at a time, of quaternions q one after the other at times t; null where there are no more. */
export function attitude(t, q, time) {
  const many = q.length / 4, after = t.findIndex(one => one > time), k = after < 0 ? t.length - 1 : after - 1;
  if (k >= many) return null;
  const next = Math.min(k + 1, many - 1), part = next > k ? (time - t[k]) / (t[next] - t[k]) : 0;
  return matrix([0, 1, 2, 3].map(i => (1 - part) * q[4 * k + i] + part * q[4 * next + i]));
}

/** The rotation that takes the unit vector to the third axis. */
export const upright = ([x, y, z]) => (z < -0.999999
  ? [[1, 0, 0], [0, -1, 0], [0, 0, -1]]
  : [[1 - x * x / (1 + z), -x * y / (1 + z), -x], [-x * y / (1 + z), 1 - y * y / (1 + z), -y], [x, y, z]]);
