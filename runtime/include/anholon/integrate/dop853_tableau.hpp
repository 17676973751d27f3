// SPDX-License-Identifier: MIT
//
// Coefficients of DOP853: order 8 in twelve stages after Dormand and Prince, with error estimates of orders
// 5 and 3 and a continuous solution of order 7 by three more stages. Hairer, Norsett & Wanner 1993, "Solving
// Ordinary Differential Equations I", sections II.5 and II.6, and their code DOP853, which prints them to 30
// digits. A test checks every condition of order in quadruple precision.
#pragma once

#include <array>

#include "anholon/integrate/decimal.hpp"

namespace anholon::integrate {

/// Stages 0 to 11 of the method; stage 12 is the end point, first of the next step; stages 13 to 15 serve
/// the continuous solution alone.
template <class Real>
struct DormandPrince853 {
  static constexpr int stages = 13;
  static constexpr int order = 8;
  static constexpr bool first_same_as_last = true;
  static constexpr int dense_stages = 3;
  static constexpr int all = stages + dense_stages;

  // Step control as theirs, without a part that remembers the last error.
  static constexpr Real integral_weight = 0;
  static constexpr Real largest_factor = 6;

  static constexpr std::array<Real, all> c = {0,
                                              0.526001519587677318785587544488e-01_decimal,
                                              0.789002279381515978178381316732e-01_decimal,
                                              0.118350341907227396726757197510_decimal,
                                              0.281649658092772603273242802490_decimal,
                                              Real(1) / 3,
                                              Real(1) / 4,
                                              Real(4) / 13,
                                              Real(127) / 195,
                                              Real(3) / 5,
                                              Real(6) / 7,
                                              1,
                                              1,
                                              Real(1) / 10,
                                              Real(1) / 5,
                                              Real(7) / 9};

  static constexpr std::array<Real, stages> b = {5.42937341165687622380535766363e-02_decimal,
                                                 0,
                                                 0,
                                                 0,
                                                 0,
                                                 4.45031289275240888144113950566_decimal,
                                                 1.89151789931450038304281599044_decimal,
                                                 -5.8012039600105847814672114227_decimal,
                                                 3.1116436695781989440891606237e-01_decimal,
                                                 -1.52160949662516078556178806805e-01_decimal,
                                                 2.01365400804030348374776537501e-01_decimal,
                                                 4.47106157277725905176885569043e-02_decimal,
                                                 0};

  static constexpr std::array<std::array<Real, stages>, stages> a = {{
      {},
      {5.26001519587677318785587544488e-02_decimal},
      {1.97250569845378994544595329183e-02_decimal, 5.91751709536136983633785987549e-02_decimal},
      {2.95875854768068491816892993775e-02_decimal, 0, 8.87627564304205475450678981324e-02_decimal},
      {2.41365134159266685502369798665e-01_decimal, 0, -8.84549479328286085344864962717e-01_decimal,
       9.24834003261792003115737966543e-01_decimal},
      {Real(1) / 27, 0, 0, 1.70828608729473871279604482173e-01_decimal,
       1.25467687566822425016691814123e-01_decimal},
      {3.7109375e-02_decimal, 0, 0, 1.70252211019544039314978060272e-01_decimal,
       6.02165389804559606850219397283e-02_decimal, -1.7578125e-02_decimal},
      {3.70920001185047927108779319836e-02_decimal, 0, 0, 1.70383925712239993810214054705e-01_decimal,
       1.07262030446373284651809199168e-01_decimal, -1.53194377486244017527936158236e-02_decimal,
       8.27378916381402288758473766002e-03_decimal},
      {6.24110958716075717114429577812e-01_decimal, 0, 0, -3.36089262944694129406857109825_decimal,
       -8.68219346841726006818189891453e-01_decimal, 2.75920996994467083049415600797e+01_decimal,
       2.01540675504778934086186788979e+01_decimal, -4.34898841810699588477366255144e+01_decimal},
      {4.77662536438264365890433908527e-01_decimal, 0, 0, -2.48811461997166764192642586468_decimal,
       -5.90290826836842996371446475743e-01_decimal, 2.12300514481811942347288949897e+01_decimal,
       1.52792336328824235832596922938e+01_decimal, -3.32882109689848629194453265587e+01_decimal,
       -2.03312017085086261358222928593e-02_decimal},
      {-9.3714243008598732571704021658e-01_decimal, 0, 0, 5.18637242884406370830023853209_decimal,
       1.09143734899672957818500254654_decimal, -8.14978701074692612513997267357_decimal,
       -1.85200656599969598641566180701e+01_decimal, 2.27394870993505042818970056734e+01_decimal,
       2.49360555267965238987089396762_decimal, -3.0467644718982195003823669022_decimal},
      {2.27331014751653820792359768449_decimal, 0, 0, -1.05344954667372501984066689879e+01_decimal,
       -2.00087205822486249909675718444_decimal, -1.79589318631187989172765950534e+01_decimal,
       2.79488845294199600508499808837e+01_decimal, -2.85899827713502369474065508674_decimal,
       -8.87285693353062954433549289258_decimal, 1.23605671757943030647266201528e+01_decimal,
       6.43392746015763530355970484046e-01_decimal},
      b,
  }};

  /// The stages of the continuous solution.
  static constexpr std::array<std::array<Real, all>, dense_stages> a_dense = {{
      {5.61675022830479523392909219681e-02_decimal, 0, 0, 0, 0, 0,
       2.53500210216624811088794765333e-01_decimal, -2.46239037470802489917441475441e-01_decimal,
       -1.24191423263816360469010140626e-01_decimal, 1.5329179827876569731206322685e-01_decimal,
       8.20105229563468988491666602057e-03_decimal, 7.56789766054569976138603589584e-03_decimal,
       -8.298e-03_decimal},
      {3.18346481635021405060768473261e-02_decimal, 0, 0, 0, 0, 2.83009096723667755288322961402e-02_decimal,
       5.35419883074385676223797384372e-02_decimal, -5.49237485713909884646569340306e-02_decimal, 0, 0,
       -1.08347328697249322858509316994e-04_decimal, 3.82571090835658412954920192323e-04_decimal,
       -3.40465008687404560802977114492e-04_decimal, 1.41312443674632500278074618366e-01_decimal},
      {-4.28896301583791923408573538692e-01_decimal, 0, 0, 0, 0, -4.69762141536116384314449447206_decimal,
       7.68342119606259904184240953878_decimal, 4.06898981839711007970213554331_decimal,
       3.56727187455281109270669543021e-01_decimal, 0, 0, 0, -1.39902416515901462129418009734e-03_decimal,
       2.9475147891527723389556272149_decimal, -9.15095847217987001081870187138_decimal},
  }};

  /// b - b^ with b^ of order 5.
  static constexpr std::array<Real, stages> error = {0.1312004499419488073250102996e-01_decimal,
                                                     0,
                                                     0,
                                                     0,
                                                     0,
                                                     -0.1225156446376204440720569753e+01_decimal,
                                                     -0.4957589496572501915214079952_decimal,
                                                     0.1664377182454986536961530415e+01_decimal,
                                                     -0.3503288487499736816886487290_decimal,
                                                     0.3341791187130174790297318841_decimal,
                                                     0.8192320648511571246570742613e-01_decimal,
                                                     -0.2235530786388629525884427845e-01_decimal,
                                                     0};
  /// b - b^ with b^ of order 3, on stages 0, 8 and 11.
  static constexpr std::array<Real, stages> error_of_order_3 = [] {
    std::array<Real, stages> difference = b;
    difference[0] -= Real(31) / 127;
    difference[8] -= Real(0.733846688281611857341361741547_decimal);
    difference[11] -= Real(3) / 136;
    return difference;
  }();

  /// Weights of the rates in the continuous solution, of order 7: at t + s h it is the start plus h times
  /// their sum. With F_0 = b, F_1 = e_0 - b, F_2 = 2b - e_0 - e_12 and F_3 to F_6 the rows of d,
  ///
  ///   s (F_0 + u (F_1 + s (F_2 + u (F_3 + s (F_4 + u (F_5 + s F_6)))))),     u = 1 - s
  static constexpr std::array<Real, all> weights(Real s) {
    const Real u = Real(1) - s;
    std::array<Real, all> sum{};
    for (int i = 0; i < all; ++i) {
      const Real b_i = i < stages ? b[i] : Real(0), first = Real(i == 0), last = Real(i == stages - 1);
      sum[i] = d[0][i] + s * (d[1][i] + u * (d[2][i] + s * d[3][i]));
      sum[i] = s * (b_i + u * ((first - b_i) + s * ((2 * b_i - first - last) + u * sum[i])));
    }
    return sum;
  }

  /// The four highest parts of the continuous solution.
  static constexpr std::array<std::array<Real, all>, 4> d = {{
      {-0.84289382761090128651353491142e+01_decimal, 0, 0, 0, 0, 0.56671495351937776962531783590_decimal,
       -0.30689499459498916912797304727e+01_decimal, 0.23846676565120698287728149680e+01_decimal,
       0.21170345824450282767155149946e+01_decimal, -0.87139158377797299206789907490_decimal,
       0.22404374302607882758541771650e+01_decimal, 0.63157877876946881815570249290_decimal,
       -0.88990336451333310820698117400e-01_decimal, 0.18148505520854727256656404962e+02_decimal,
       -0.91946323924783554000451984436e+01_decimal, -0.44360363875948939664310572000e+01_decimal},
      {0.10427508642579134603413151009e+02_decimal, 0, 0, 0, 0, 0.24228349177525818288430175319e+03_decimal,
       0.16520045171727028198505394887e+03_decimal, -0.37454675472269020279518312152e+03_decimal,
       -0.22113666853125306036270938578e+02_decimal, 0.77334326684722638389603898808e+01_decimal,
       -0.30674084731089398182061213626e+02_decimal, -0.93321305264302278729567221706e+01_decimal,
       0.15697238121770843886131091075e+02_decimal, -0.31139403219565177677282850411e+02_decimal,
       -0.93529243588444783865713862664e+01_decimal, 0.35816841486394083752465898540e+02_decimal},
      {0.19985053242002433820987653617e+02_decimal, 0, 0, 0, 0, -0.38703730874935176555105901742e+03_decimal,
       -0.18917813819516756882830838328e+03_decimal, 0.52780815920542364900561016686e+03_decimal,
       -0.11573902539959630126141871134e+02_decimal, 0.68812326946963000169666922661e+01_decimal,
       -0.10006050966910838403183860980e+01_decimal, 0.77771377980534432092869265740_decimal,
       -0.27782057523535084065932004339e+01_decimal, -0.60196695231264120758267380846e+02_decimal,
       0.84320405506677161018159903784e+02_decimal, 0.11992291136182789328035130030e+02_decimal},
      {-0.25693933462703749003312586129e+02_decimal, 0, 0, 0, 0, -0.15418974869023643374053993627e+03_decimal,
       -0.23152937917604549567536039109e+03_decimal, 0.35763911791061412378285349910e+03_decimal,
       0.93405324183624310003907691704e+02_decimal, -0.37458323136451633156875139351e+02_decimal,
       0.10409964950896230045147246184e+03_decimal, 0.29840293426660503123344363579e+02_decimal,
       -0.43533456590011143754432175058e+02_decimal, 0.96324553959188282948394950600e+02_decimal,
       -0.39177261675615439165231486172e+02_decimal, -0.14972683625798562581422125276e+03_decimal},
  }};
};

}  // namespace anholon::integrate
