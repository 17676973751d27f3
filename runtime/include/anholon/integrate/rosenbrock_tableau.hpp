// SPDX-License-Identifier: MIT
//
// Linearly implicit (Rosenbrock-Wanner) tableaux as data, in the form that needs no product with the Jacobian
// (Hairer & Wanner 1996, "Solving Ordinary Differential Equations II", IV.7):
//
//   (1/(gamma h) - f_y) u_i = f(t + alpha_i h, y + sum_{j<i} a_ij u_j) + sum_{j<i} c_ij/h u_j + gamma_i h f_t
//
//   y_1 = y + sum_j b_j u_j
//
// with f_y and f_t at (t, y). The continuous solution is, with s in [0, 1] and d_k = sum_j dense_kj u_j,
//
//   y(t + s h) = (1 - s) y + s ( y_1 + (1 - s) (d_1 + s (d_2 + s d_3)) ).
#pragma once

#include <array>

namespace anholon::integrate {

/// Rodas5P: order 5 with an embedded solution and a continuous one of order 4; stiffly accurate, L-stable
/// (A-stable with R(infinity) = 0), and of order 5 also where fast components are tied to slow ones
/// algebraically. Coefficients of Steinebach 2023, "Construction of Rosenbrock-Wanner method Rodas5P and
/// numerical benchmarks within the Julia Differential Equations package", BIT Numer. Math. 63, given there to
/// 16 digits: in long double, errors do not fall below some 1e-16.
template <class Real>
struct Rodas5P {
  static constexpr int stages = 8;
  static constexpr int order = 5;

  using Row = std::array<Real, stages>;
  static constexpr Real gamma = Real(0.21193756319429014L);
  static constexpr Row alpha = {0,
                                Real(0.6358126895828704L),
                                Real(0.4095798393397535L),
                                Real(0.9769306725060716L),
                                Real(0.4288403609558664L),
                                1,
                                1,
                                1};
  static constexpr Row gamma_sum = {gamma,
                                    Real(-0.42387512638858027L),
                                    Real(-0.3384627126235924L),
                                    Real(1.8046452872882734L),
                                    Real(2.325825639765069L),
                                    0,
                                    0,
                                    0};
  static constexpr std::array<Row, stages> a = {{
      {0, 0, 0, 0, 0, 0, 0, 0},
      {3, 0, 0, 0, 0, 0, 0, 0},
      {Real(2.849394379747939L), Real(0.45842242204463923L), 0, 0, 0, 0, 0, 0},
      {Real(-6.954028509809101L), Real(2.489845061869568L), Real(-10.358996098473584L), 0, 0, 0, 0, 0},
      {Real(2.8029986275628964L), Real(0.5072464736228206L), Real(-0.3988312541770524L),
       Real(-0.04721187230404641L), 0, 0, 0, 0},
      {Real(-7.502846399306121L), Real(2.561846144803919L), Real(-11.627539656261098L),
       Real(-0.18268767659942256L), Real(0.030198172008377946L), 0, 0, 0},
      {Real(-7.502846399306121L), Real(2.561846144803919L), Real(-11.627539656261098L),
       Real(-0.18268767659942256L), Real(0.030198172008377946L), 1, 0, 0},
      {Real(-7.502846399306121L), Real(2.561846144803919L), Real(-11.627539656261098L),
       Real(-0.18268767659942256L), Real(0.030198172008377946L), 1, 1, 0},
  }};
  static constexpr std::array<Row, stages> c = {{
      {0, 0, 0, 0, 0, 0, 0, 0},
      {Real(-14.155112264123755L), 0, 0, 0, 0, 0, 0, 0},
      {Real(-17.97296035885952L), Real(-2.859693295451294L), 0, 0, 0, 0, 0, 0},
      {Real(147.12150275711716L), Real(-1.41221402718213L), Real(71.68940251302358L), 0, 0, 0, 0, 0},
      {Real(165.43517024871676L), Real(-0.4592823456491126L), Real(42.90938336958603L),
       Real(-5.961986721573306L), 0, 0, 0, 0},
      {Real(24.854864614690072L), Real(-3.0009227002832186L), Real(47.4931110020768L),
       Real(5.5814197821558125L), Real(-0.6610691825249471L), 0, 0, 0},
      {Real(30.91273214028599L), Real(-3.1208243349937974L), Real(77.79954646070892L),
       Real(34.28646028294783L), Real(-19.097331116725623L), Real(-28.087943162872662L), 0, 0},
      {Real(37.80277123390563L), Real(-3.2571969029072276L), Real(112.26918849496327L),
       Real(66.9347231244047L), Real(-40.06618937091002L), Real(-54.66780262877968L),
       Real(-9.48861652309627L), 0},
  }};
  static constexpr Row b = {Real(-7.502846399306121L),
                            Real(2.561846144803919L),
                            Real(-11.627539656261098L),
                            Real(-0.18268767659942256L),
                            Real(0.030198172008377946L),
                            1,
                            1,
                            1};
  /// b - b^, with b^ the embedded solution: the argument of the last stage.
  static constexpr Row error = {0, 0, 0, 0, 0, 0, 0, 1};

  static constexpr int dense_terms = 3;
  static constexpr std::array<Row, dense_terms> dense = {{
      {Real(25.948786856663858L), Real(-2.5579724845846235L), Real(10.433815404888879L),
       Real(-2.3679251022685204L), Real(0.524948541321073L), Real(1.1241088310450404L),
       Real(0.4272876194431874L), Real(-0.17202221070155493L)},
      {Real(-9.91568850695171L), Real(-0.9689944594115154L), Real(3.0438037242978453L),
       Real(-24.495224566215796L), Real(20.176138334709044L), Real(15.98066361424651L),
       Real(-6.789040303419874L), Real(-6.710236069923372L)},
      {Real(11.419903575922262L), Real(2.8879645146136994L), Real(72.92137995996029L),
       Real(80.12511834622643L), Real(-52.072871366152654L), Real(-59.78993625266729L),
       Real(-0.15582684282751913L), Real(4.883087185713722L)},
  }};
};

}  // namespace anholon::integrate
