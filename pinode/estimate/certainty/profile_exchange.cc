#include "pinode/estimate/certainty/profile_exchange.h"

#include <cstddef>
#include <string>
#include <type_traits>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {
namespace {

// The numbers that every profile has, in one order for writing and reading.
template <typename Profile, typename Visit>
void VisitNumbers(Profile* p, const Visit& visit) {
  visit(&p->estimate);
  visit(&p->lower95);
  visit(&p->upper95);
  visit(&p->lower99);
  visit(&p->upper99);
  visit(&p->threshold95);
  visit(&p->threshold99);
  visit(&p->linear_lower95);
  visit(&p->linear_upper95);
  visit(&p->determination);
  visit(&p->found_lower);
  visit(&p->unsettled);
  visit(&p->linearizations);
}

Vector NumbersOf(const ParameterProfile& profile) {
  std::vector<double> numbers;
  VisitNumbers(&profile, [&numbers](const auto* number) {
    numbers.push_back(static_cast<double>(*number));
  });
  for (const ParameterProfile::Point& point : profile.points) {
    numbers.push_back(point.value);
    numbers.push_back(point.ratio);
  }
  return Eigen::Map<const Vector>(numbers.data(),
                                  static_cast<Eigen::Index>(numbers.size()));
}

void SetNumbers(const Vector& numbers, ParameterProfile* profile) {
  Eigen::Index at = 0;
  VisitNumbers(profile, [&](auto* number) {
    *number =
        static_cast<std::remove_pointer_t<decltype(number)>>(numbers[at++]);
  });
  profile->points.clear();
  for (; at + 1 < numbers.size(); at += 2) {
    profile->points.push_back({numbers[at], numbers[at + 1]});
  }
}

}  // namespace

bool BroadcastProfile(int owner, Communicator* communicator, char* done,
                      ParameterProfile* profile) {
  if (communicator->size() == 1) return true;
  if (!communicator->Broadcast(owner, done, 1)) return false;
  if (*done == 0) return true;
  Vector numbers = NumbersOf(*profile);
  auto num_combinations = static_cast<double>(profile->combinations.size());
  if (!communicator->Broadcast(owner, &numbers) ||
      !communicator->Broadcast(owner, &num_combinations, sizeof(double)) ||
      !communicator->Broadcast(owner, &profile->name) ||
      !communicator->Broadcast(owner, &profile->unit)) {
    return false;
  }
  SetNumbers(numbers, profile);
  profile->combinations.resize(static_cast<size_t>(num_combinations));
  for (std::string& combination : profile->combinations) {
    if (!communicator->Broadcast(owner, &combination)) return false;
  }
  return true;
}

}  // namespace pinode
