#include "pinode/problem/tuning.h"

#include <gtest/gtest.h>

#include <set>

namespace pinode {
namespace {

TEST(TuningFields, ListsEveryConstantOnce) {
  Tuning tuning;
  const std::vector<TuningField> fields = TuningFields(&tuning);
  std::set<std::string> names;
  std::set<const void*> addresses;
  size_t bytes = 0;
  for (const TuningField& field : fields) {
    names.insert(field.name);
    std::visit(
        [&](const auto* number) {
          addresses.insert(number);
          bytes += sizeof(*number);
          EXPECT_GE(static_cast<const void*>(number), &tuning) << field.name;
          EXPECT_LT(static_cast<const void*>(number), &tuning + 1)
              << field.name;
        },
        field.value);
  }
  EXPECT_EQ(names.size(), fields.size());
  EXPECT_EQ(addresses.size(), fields.size());
  // A constant that the list forgets would leave more than padding.
  EXPECT_GT(bytes + 48, sizeof(Tuning));
}

TEST(TuningFields, ChangesTheConstantsThemselves) {
  Tuning tuning;
  for (const TuningField& field : TuningFields(&tuning)) {
    const double before = field.Get();
    EXPECT_GT(before, 0.0) << field.name;
    field.Set(2.0 * before);
    EXPECT_EQ(field.Get(), 2.0 * before) << field.name;
  }
  EXPECT_EQ(tuning.gaps.closed, 2.0 * Tuning().gaps.closed);
  EXPECT_EQ(tuning.solve.max_rounds, 2 * Tuning().solve.max_rounds);
}

TEST(TuningFields, KeepsIntegersWhole) {
  Tuning tuning;
  for (const TuningField& field : TuningFields(&tuning)) {
    if (field.name == "stages.network_divisor") field.Set(1.5);
    if (field.name == "stages.growth") field.Set(0.2);
  }
  EXPECT_EQ(tuning.stages.network_divisor, 2);
  EXPECT_EQ(tuning.stages.growth, 1);
}

}  // namespace
}  // namespace pinode
