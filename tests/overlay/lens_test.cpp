#include "overlay/lens.hpp"

#include <gmock/gmock.h>

namespace depthscope::overlay {
namespace {

TEST(ValidRadius, EndsBeforeABarrelPolynomialFoldsBack) {
  CameraModel c;
  c.k = {-0.28, 0, 0, 0, 0};
  const double fold = std::sqrt(1 / (3 * 0.28));
  const double r = validRadius(c);
  EXPECT_LT(r, fold);
  EXPECT_GT(r, 0.9 * fold);
  double before = 0;
  for (double x = 0.01; x < r; x += 0.01) {
    const double d = c.distort({x, 0}).x();
    EXPECT_GT(d, before);
    before = d;
  }
}

TEST(ValidRadius, IsWideForALensWithoutDistortion) {
  EXPECT_GT(validRadius(CameraModel{}), 10);
}

TEST(ValidRadius, EndsWhereAFisheyeFoldsBack) {
  CameraModel c;
  c.kind = CameraModel::Kind::Fisheye;
  c.k = {-0.3, 0, 0, 0, 0};
  EXPECT_LT(validRadius(c), std::tan(std::sqrt(1 / (3 * 0.3))));
  EXPECT_GT(validRadius(c), std::tan(0.9 * std::sqrt(1 / (3 * 0.3))));
}

}  // namespace
}  // namespace depthscope::overlay
