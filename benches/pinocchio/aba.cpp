// Time per call of Pinocchio's C++ ABA (world and local convention) and CRBA on random states; thread CPU time,
// medians. Printed as JSON in µs, to stand beside `realnoid bench --json`.
#include <algorithm>
#include <ctime>
#include <iostream>
#include <random>
#include <vector>

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/multibody.hpp>
#include <pinocchio/serialization.hpp>

namespace pin = pinocchio;

constexpr int kStates = 64;
constexpr int kBatch = 256;

double CpuSeconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return t.tv_sec + 1e-9 * t.tv_nsec;
}

template <class Call>
double MedianMicroseconds(double seconds, Call call) {
  std::vector<double> times;
  for (double spent = 0; spent < seconds || times.size() < 11;) {
    const double start = CpuSeconds();
    for (int n = 0; n < kBatch; ++n) call(n % kStates);
    const double took = CpuSeconds() - start;
    spent += took;
    times.push_back(1e6 * took / kBatch);
  }
  std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
  return times[times.size() / 2];
}

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "usage: aba MODEL.xml [seconds per function]\n";
    return 2;
  }
  const double seconds = argc > 2 ? std::atof(argv[2]) : 0.5;
  pin::Model model;
  model.loadFromXML(argv[1], "model");
  pin::Data data(model);
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Eigen::VectorXd> q, v;
  const Eigen::VectorXd tau = Eigen::VectorXd::NullaryExpr(model.nv, [&] { return uniform(generator); });
  for (int n = 0; n < kStates; ++n) {
    Eigen::VectorXd step = Eigen::VectorXd::NullaryExpr(model.nv, [&] { return uniform(generator); });
    q.push_back(pin::integrate(model, pin::neutral(model), step));
    v.push_back(Eigen::VectorXd::NullaryExpr(model.nv, [&] { return uniform(generator); }));
  }
  const auto world = MedianMicroseconds(
      seconds, [&](int n) { pin::aba(model, data, q[n], v[n], tau, pin::Convention::WORLD); });
  const auto local = MedianMicroseconds(
      seconds, [&](int n) { pin::aba(model, data, q[n], v[n], tau, pin::Convention::LOCAL); });
  const auto crba = MedianMicroseconds(seconds, [&](int n) { pin::crba(model, data, q[n], pin::Convention::LOCAL); });
  std::cout << "{\"aba_world\": " << world << ", \"aba_local\": " << local
            << ", \"crba\": " << crba << "}\n";
}
