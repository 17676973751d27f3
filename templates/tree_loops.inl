// Loops over the tables of a tree, for functions whose straight line would be longer than the caches of a
// processor. Arrays are row-major; zero, one, plus and times are all that Real needs.

/// M = L^T D L from the tips to the base (Featherstone 2008, table 6.3): L unit lower triangular.
/// @param[in]     parent  (n) next coordinate towards the base, -1 behind the last
/// @param[in,out] A       (n x n) M, of which the lower triangle is read; then L
/// @param[out]    D       (n) the diagonal
template <class Real>
inline void factor_mass_matrix(int n, const int* parent, Real* A, Real* D) noexcept {
  for (int k = n - 1; k >= 0; --k) {
    D[k] = A[k * n + k];
    const Real inverse = constant<Real>(1.0L) / D[k];
    for (int i = parent[k]; i >= 0; i = parent[i]) {
      const Real l = A[k * n + i] * inverse;
      for (int j = i; j >= 0; j = parent[j]) A[i * n + j] = A[i * n + j] - l * A[k * n + j];
      A[k * n + i] = l;
    }
    A[k * n + k] = constant<Real>(1.0L);
    for (int i = 0; i < k; ++i) A[i * n + k] = constant<Real>(0.0L);
  }
}

/// Inverse of M = L^T D L: W D^-1 W^T with W = L^-1, column of W by column, of which each has entries in one
/// subtree only.
/// @param[in]     parent  (n) as in factor_mass_matrix
/// @param[in]     end     (n) one behind the last coordinate of the subtree that begins at k
/// @param[in,out] A       (n x n) L; then the inverse
/// @param[in,out] D       (n) the diagonal; then its inverse
template <class Real>
inline void invert_mass_factor(int n, const int* parent, const int* end, Real* A, Real* D) noexcept {
  for (int i = n - 1; i >= 0; --i) {  // rows of W from W L = 1: those above are still rows of L
    for (int j = parent[i]; j >= 0; j = parent[j]) A[i * n + j] = -A[i * n + j];
    for (int k = parent[i]; k >= 0; k = parent[k]) {
      for (int j = parent[k]; j >= 0; j = parent[j]) A[i * n + j] = A[i * n + j] - A[i * n + k] * A[k * n + j];
    }
  }
  for (int i = 0; i < n; ++i) {  // W^T above the diagonal, room for the inverse below
    D[i] = constant<Real>(1.0L) / D[i];
    A[i * n + i] = constant<Real>(0.0L);
    for (int j = 0; j < i; ++j) {
      A[j * n + i] = A[i * n + j];
      A[i * n + j] = constant<Real>(0.0L);
    }
  }
  for (int k = 0; k < n; ++k) {
    A[k * n + k] = A[k * n + k] + D[k];
    for (int i = k + 1; i < end[k]; ++i) {
      const Real scaled = A[k * n + i] * D[k];
      A[i * n + k] = A[i * n + k] + scaled;
      for (int j = k + 1; j <= i; ++j) A[i * n + j] = A[i * n + j] + scaled * A[k * n + j];
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < i; ++j) A[j * n + i] = A[i * n + j];
  }
}

/// Y of (base wrench, joint forces) = Y pi: the wrench that each inertial figure of each body asks for, on the
/// axes of the joints below it. All in the axes of the reference body, about its origin.
/// @param[in]  parent     (bodies) parents come first; body 0 is the reference body
/// @param[in]  row        (bodies) of Y, of the joint that carries the body
/// @param[in]  component  (base_rows) of the base wrench that the first rows are
/// @param[in]  motion     (bodies x 21) R and p of the body's frame, then in its own axes the angular velocity,
///                        its derivative, and the acceleration of the origin minus gravity
/// @param[in]  axes       (bodies x 6) twist of the joint at unit rate
/// @param[out] Y          (rows x 10 bodies)
template <class Real>
inline void regressor_rows(int bodies, const int* parent, const int* row, int base_rows, const int* component,
                           int rows, const Real* motion, const Real* axes, Real* Y) noexcept {
  const int columns = 10 * bodies;
  for (int i = 0; i < rows * columns; ++i) Y[i] = constant<Real>(0.0L);
  for (int k = 0; k < bodies; ++k) {
    const Real* R = motion + 21 * k;
    const Real* p = R + 9;
    const Real* w = R + 12;
    const Real* u = R + 15;
    const Real* a = R + 18;
    const Real xx = w[0] * w[0], yy = w[1] * w[1], zz = w[2] * w[2];
    const Real xy = w[0] * w[1], xz = w[0] * w[2], yz = w[1] * w[2];
    const Real zero = constant<Real>(0.0L);
    // forces of m, mx, my, mz, and moments of mx, my, mz, Ixx, Iyy, Izz, Ixy, Ixz, Iyz, in the body's axes
    const Real force[4][3] = {{a[0], a[1], a[2]},
                              {-(yy + zz), xy + u[2], xz - u[1]},
                              {xy - u[2], -(xx + zz), yz + u[0]},
                              {xz + u[1], yz - u[0], -(xx + yy)}};
    const Real moment[9][3] = {{zero, -a[2], a[1]},
                               {a[2], zero, -a[0]},
                               {-a[1], a[0], zero},
                               {u[0], xz, -xy},
                               {-yz, u[1], xy},
                               {yz, -xz, u[2]},
                               {u[1] - xz, u[0] + yz, xx - yy},
                               {u[2] + xy, zz - xx, u[0] - yz},
                               {yy - zz, u[2] - xy, u[1] + xz}};
    Real wrench[6][10];
    for (int c = 0; c < 4; ++c) {
      for (int i = 0; i < 3; ++i)
        wrench[i][c] = R[3 * i] * force[c][0] + R[3 * i + 1] * force[c][1] + R[3 * i + 2] * force[c][2];
      wrench[3][c] = p[1] * wrench[2][c] - p[2] * wrench[1][c];
      wrench[4][c] = p[2] * wrench[0][c] - p[0] * wrench[2][c];
      wrench[5][c] = p[0] * wrench[1][c] - p[1] * wrench[0][c];
    }
    for (int c = 0; c < 9; ++c) {
      for (int i = 0; i < 3; ++i) {
        const Real turned =
            R[3 * i] * moment[c][0] + R[3 * i + 1] * moment[c][1] + R[3 * i + 2] * moment[c][2];
        wrench[3 + i][1 + c] = c < 3 ? wrench[3 + i][1 + c] + turned : turned;
        if (c >= 3) wrench[i][1 + c] = zero;
      }
    }
    for (int b = 0; b < base_rows; ++b) {
      for (int c = 0; c < 10; ++c) Y[b * columns + 10 * k + c] = wrench[component[b]][c];
    }
    for (int i = k; i > 0; i = parent[i]) {
      const Real* s = axes + 6 * i;
      Real* y = Y + row[i] * columns + 10 * k;
      for (int c = 0; c < 4; ++c) {
        y[c] = s[0] * wrench[0][c] + s[1] * wrench[1][c] + s[2] * wrench[2][c] + s[3] * wrench[3][c] +
               s[4] * wrench[4][c] + s[5] * wrench[5][c];
      }
      for (int c = 4; c < 10; ++c) y[c] = s[3] * wrench[3][c] + s[4] * wrench[4][c] + s[5] * wrench[5][c];
    }
  }
}
