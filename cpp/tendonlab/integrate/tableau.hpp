#pragma once
namespace tendonlab::integrate {
/// Rodas4 (Hairer and Wanner): order 4, stiffly accurate, cubic dense output. k_i = stage increments, error = last of
/// them.
struct Rodas4 {
  static constexpr int stages = 6;
  static constexpr double gamma = 0.25;
  static constexpr double A[6][6] = {{0},
                                     {1.544},
                                     {0.9466785280815826, 0.2557011698983284},
                                     {3.314825187068521, 2.896124015972201, 0.9986419139977817},
                                     {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.687886036105895},
                                     {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.687886036105895, 1}};
  static constexpr double C[6][6] = {
      {0},
      {-5.6688},
      {-2.430093356833875, -0.2063599157091915},
      {-0.1073529058151375, -9.594562251023355, -20.47028614809616},
      {7.496443313967647, -10.24680431464352, -33.99990352819905, 11.7089089320616},
      {8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136, -6.058818238834054}};
  static constexpr double c[6] = {0, .386, .21, .63, 1, 1}, d[6] = {.25, -.1043, .1035, -.0362, 0, 0};
  static constexpr double D[2][6] = {
      {10.12623508344586, -7.487995877610167, -34.80091861555747, -7.992771707568823, 1.025137723295662, 0},
      {-0.6762803392801253, 6.087714651680015, 16.43084320892478, 24.76722511418386, -6.594389125716872, 0}};
};

/// Kutta's 3/8 rule: explicit, order 4; its error of order 3 from the rate at the end of the step (Hairer, Norsett and
/// Wanner, section II.4).
struct Kutta {
  static constexpr int stages = 5;
  static constexpr double A[5][4] = {{0}, {1.0 / 3}, {-1.0 / 3, 1}, {1, -1, 1}, {1.0 / 8, 3.0 / 8, 3.0 / 8, 1.0 / 8}};
  static constexpr double c[5] = {0, 1.0 / 3, 2.0 / 3, 1, 1},
                          error[5] = {1.0 / 24, -1.0 / 8, 1.0 / 8, 1.0 / 8, -1.0 / 6};
};
}  // namespace tendonlab::integrate
