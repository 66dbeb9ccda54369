#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "compiler/bytecode/function.h"
#include "tests/unit/interpreter/recording_host.h"

using namespace pmac::test;

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

double call(Function function, double x, double y = 0, double z = 0) {
  RecordingHost host;
  const double arguments[] = {x, y, z};
  return pmac::runtime::apply_function(function, arguments, host);
}

}  // namespace

TEST_CASE("functions: values by hand", "[functions]") {
  CHECK(call(Function::kAbs, -3) == 3);
  CHECK(call(Function::kAcos, -1) == Approx(3.14159265358979));
  CHECK(call(Function::kAcosd, 0.5) == Approx(60));
  CHECK(call(Function::kAcosh, 1) == 0);
  CHECK(call(Function::kAsin, 1) == Approx(1.5707963267949));
  CHECK(call(Function::kAsind, -0.5) == Approx(-30));
  CHECK(call(Function::kAsinh, 0) == 0);
  CHECK(call(Function::kAtan, 1) == Approx(0.785398163397448));
  CHECK(call(Function::kAtand, 1) == Approx(45));
  CHECK(call(Function::kAtanh, 0.5) == Approx(0.549306144334055));
  CHECK(call(Function::kAtan2, 1, -1) == Approx(2.35619449019234));
  CHECK(call(Function::kAtan2d, 1, -1) == Approx(135));
  CHECK(call(Function::kCbrt, -27) == Approx(-3));
  CHECK(call(Function::kCeil, -1.5) == -1);
  CHECK(call(Function::kCos, 0) == 1);
  CHECK(call(Function::kCosh, 0) == 1);
  CHECK(call(Function::kExp, 1) == Approx(2.71828182845905));
  CHECK(call(Function::kExp2, 10) == 1024);
  CHECK(call(Function::kFloor, -1.5) == -2);
  CHECK(call(Function::kInt, -1.5) == -2);
  CHECK(call(Function::kLn, std::exp(2.0)) == Approx(2));
  CHECK(call(Function::kLog, std::exp(2.0)) == Approx(2));
  CHECK(call(Function::kLog10, 1000) == Approx(3));
  CHECK(call(Function::kLog2, 8) == 3);
  CHECK(call(Function::kMadd, 2, 3, 4) == 10);
  CHECK(call(Function::kPow, 2, 0.5) == Approx(1.4142135623731));
  CHECK(call(Function::kQnrt, -32) == Approx(-2));
  CHECK(call(Function::kQrrt, 81) == Approx(3));
  CHECK(call(Function::kRem, -7, 3) == -1);
  CHECK(call(Function::kRint, 2.5) == 2);
  CHECK(call(Function::kRnd, 2.5) == 3);
  CHECK(call(Function::kRnd, -2.5) == -3);
  CHECK(call(Function::kSgn, -0.1) == -1);
  CHECK(call(Function::kSgn, 0) == 0);
  CHECK(call(Function::kSin, 0) == 0);
  CHECK(call(Function::kSinh, 0) == 0);
  CHECK(call(Function::kSqrt, 2) == Approx(1.4142135623731));
  CHECK(call(Function::kTan, 0) == 0);
  CHECK(call(Function::kTanh, 0) == 0);
}

TEST_CASE("functions: degrees are exact at the angles that people write", "[functions]") {
  CHECK(call(Function::kSind, 180) == 0);
  CHECK(call(Function::kSind, 30) == 0.5);
  CHECK(call(Function::kSind, -90) == -1);
  CHECK(call(Function::kSind, 270) == -1);
  CHECK(call(Function::kSind, 3600000150) == 0.5);
  CHECK(call(Function::kCosd, 90) == 0);
  CHECK(call(Function::kCosd, 60) == 0.5);
  CHECK(call(Function::kCosd, 180) == -1);
  CHECK(call(Function::kCosd, -270) == 0);
  CHECK(call(Function::kTand, 45) == 1);
  CHECK(call(Function::kTand, 135) == -1);
  CHECK(call(Function::kTand, 180) == 0);
  CHECK(std::isinf(call(Function::kTand, 90)));
  for (double angle_deg = -720; angle_deg <= 720; angle_deg += 0.37) {
    const double angle_rad = angle_deg * 3.14159265358979323846 / 180;
    CHECK(call(Function::kSind, angle_deg) == Approx(std::sin(angle_rad)).margin(1e-14));
    CHECK(call(Function::kCosd, angle_deg) == Approx(std::cos(angle_rad)).margin(1e-14));
  }
}

TEST_CASE("functions: domain errors are nan and isnan knows them", "[functions]") {
  CHECK(std::isnan(call(Function::kAcosd, 1.2)));
  CHECK(std::isnan(call(Function::kSqrt, -1)));
  CHECK(std::isnan(call(Function::kLn, -1)));
  CHECK(std::isnan(call(Function::kSind, kInf)));
  CHECK(std::isnan(call(Function::kSgn, call(Function::kSqrt, -1))));
  CHECK(call(Function::kIsNan, call(Function::kSqrt, -1)) == 1);
  CHECK(call(Function::kIsNan, kInf) == 0);
}

TEST_CASE("functions: randx and seed go to the host", "[functions]") {
  RecordingHost host;
  const double argument[] = {8.0};
  CHECK(pmac::runtime::apply_function(Function::kRandx, argument, host) == 4);
  CHECK(pmac::runtime::apply_function(Function::kSeed, argument, host) == 8);
  CHECK(host.log == std::vector<std::string>{"seed 8"});
}
