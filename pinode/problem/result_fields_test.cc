#include "pinode/problem/result_fields.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace pinode {
namespace {

// Converts to the type of any member.
struct Anything {
  template <typename T>
  operator T() const;
};

template <typename T, size_t... Is>
constexpr auto TakesInitialisers(std::index_sequence<Is...>)
    -> decltype(T{(static_cast<void>(Is), Anything())...}, true) {
  return true;
}
template <typename T, size_t N>
constexpr auto TakesInitialisers(int)
    -> decltype(TakesInitialisers<T>(std::make_index_sequence<N>())) {
  return true;
}
template <typename T, size_t N>
constexpr bool TakesInitialisers(...) {
  return false;
}

// Number of data members of an aggregate: as many initialisers as it takes.
template <typename T, size_t N = 64>
constexpr size_t NumMembers() {
  if constexpr (N == 0 || TakesInitialisers<T, N>(0)) {
    return N;
  } else {
    return NumMembers<T, N - 1>();
  }
}

template <typename T>
class ResultFields : public ::testing::Test {};
using Results =
    ::testing::Types<ChannelScore, RecordScore, MotionLevel, ParameterEstimate,
                     ModeMatch, ModeScore, LoadEvidence, AmbientScore, FrfScore,
                     ForceEstimate, IterationRecord, StageRecord, Explanation,
                     Finding, ParameterProfile::Point, ParameterProfile,
                     ModelChoice::Step, ModelChoice, IdentifiedModel,
                     FitSummary>;
TYPED_TEST_SUITE(ResultFields, Results);

// A member that is missing in the table would be lost in archives and files.
TYPED_TEST(ResultFields, TableHasAllMembers) {
  EXPECT_EQ(NumTabulatedFields<TypeParam>(), NumMembers<TypeParam>());
}

TEST(VisitFields, GoesThroughThemByName) {
  StageRecord stage;
  stage.num_segments = 3;
  std::vector<std::string> names;
  VisitFields(stage, [&names](const char* name, auto& value) {
    names.push_back(name);
    value = {};
  });
  EXPECT_EQ(names, (std::vector<std::string>{"segment_samples", "num_segments",
                                             "iterations", "free_run_error",
                                             "largest_gap", "rolled_back"}));
  EXPECT_EQ(stage.num_segments, 0);
}

}  // namespace
}  // namespace pinode
