#include "pinode/report/modes_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// Report of a beam that is held at both ends, at five places; no record.
struct ModesReportExample {
  explicit ModesReportExample(int modes) {
    constexpr int kPlaces = 5;
    for (int i = 0; i < kPlaces; ++i) {
      merged.places.push_back("u" + std::to_string(i + 1));
    }
    for (int m = 1; m <= modes; ++m) {
      MergedMode mode;
      mode.mode.frequency_hz = m;
      mode.mode.damping_ratio = 0.01;
      mode.mode.degrees_of_freedom = 20.0;
      mode.mode.shape.resize(kPlaces);
      for (int i = 0; i < kPlaces; ++i) {
        mode.mode.shape[i] = std::sin(0.5 * m * (i + 1));
      }
      mode.mode.shape_sigma_real = Vector::Constant(kPlaces, 0.01);
      mode.mode.shape_sigma_imaginary = mode.mode.shape_sigma_real;
      merged.modes.push_back(mode);
    }
    input.title = "Beam";
    input.records = &records;
    input.by_record = &by_record;
    input.merged = &merged;
  }

  MergedModes merged;
  std::vector<ResponseRecord> records;
  std::vector<ModesOfRecord> by_record;
  ModesReportInput input;
};

TEST(ModesReport, ShowsMacOfAll) {
  const ModesReportExample example(3);
  const std::string page = RenderModesReport(example.input, {});
  EXPECT_THAT(page, HasSubstr("3 modes"));
  EXPECT_THAT(page, HasSubstr("MAC between the modes"));
}

TEST(ModesReport, SaysOfHowManyTablesAndShapesAre) {
  const ModesReportExample example(24);
  const std::string page = RenderModesReport(example.input, {});
  EXPECT_THAT(page, HasSubstr("MAC between the first 20 of 24 modes"));
  EXPECT_EQ(MakeIdentifiedShapesFigure(example.merged, 16)
                .caption.find("The first 16 of 24 mode shapes"),
            0u);
  EXPECT_THAT(MakeIdentifiedShapesFigure(example.merged, 24).caption,
              Not(HasSubstr("first")));
}

TEST(ModesReport, HasNoMacOfOne) {
  const ModesReportExample example(1);
  EXPECT_THAT(RenderModesReport(example.input, {}), Not(HasSubstr("MAC")));
}

}  // namespace
}  // namespace pinode
