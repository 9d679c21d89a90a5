#include <algorithm>
#include <cmath>

#include "pinode/problem/ambient_record.h"

namespace pinode {
namespace {

// A pair needs more numbers than a parameter to tell noise from an error of the
// model.
constexpr Eigen::Index kFewestFrfLines = 10;

bool HasFrfQuantity(const Observation& response) {
  return response.quantity == Quantity::kDisplacement ||
         response.quantity == Quantity::kVelocity ||
         response.quantity == Quantity::kRelativeAcceleration;
}

// Says which terms of the dynamics FRFs have no place for; empty: none.
std::string ForeignTerms(const StructuralDynamics& dynamics) {
  if (!dynamics.networks().empty()) return "a network";
  if (!dynamics.laws().empty()) {
    return "an element, a library or a network with memory";
  }
  if (!dynamics.prescribed().empty()) return "a prescribed motion";
  return "";
}

bool AreValidIndices(const std::vector<int>& indices, Eigen::Index count,
                     int num_sensors) {
  return (indices.empty() ||
          static_cast<Eigen::Index>(indices.size()) == count) &&
         std::all_of(indices.begin(), indices.end(), [num_sensors](int index) {
           return index >= -1 && index < num_sensors;
         });
}

bool AreValidFrfLines(const Vector& frequencies) {
  if (frequencies.size() < kFewestFrfLines || !frequencies.allFinite() ||
      !(frequencies[0] > 0.0)) {
    return false;
  }
  for (Eigen::Index k = 1; k < frequencies.size(); ++k) {
    if (!(frequencies[k] > frequencies[k - 1])) return false;
  }
  return true;
}

}  // namespace

std::string FrfRecord::PairName(Eigen::Index pair) const {
  return responses[static_cast<size_t>(pair % num_responses())].name + "/" +
         reference_names[static_cast<size_t>(pair / num_responses())];
}

bool FrfRecord::IsValid(const StructuralDynamics& dynamics, int num_sensors,
                        std::string* error) const {
  const std::string begin = "frequency responses '" + name + "': ";
  const auto fail = [&](const std::string& what) {
    *error = begin + what;
    return false;
  };
  const std::string foreign = ForeignTerms(dynamics);
  if (!foreign.empty()) {
    return fail("the model has " + foreign +
                ", which frequency responses know nothing of; fit records of "
                "time, or leave it out");
  }
  if (!AreValidFrfLines(frequencies)) {
    return fail(
        "expected at least 10 lines with positive, ascending "
        "frequencies in the band");
  }
  if (responses.empty() || references.cols() == 0) {
    return fail("expected at least one response and one reference");
  }
  for (const Observation& response : responses) {
    if (!HasFrfQuantity(response)) {
      return fail("response '" + response.name +
                  "' is no displacement, velocity or relative acceleration");
    }
    if (response.weights.size() != dynamics.num_dofs() ||
        !response.weights.allFinite()) {
      return fail("response '" + response.name +
                  "' needs a finite weight for each DOF of the model");
    }
  }
  if (references.rows() != dynamics.num_dofs() || !references.allFinite() ||
      static_cast<Eigen::Index>(reference_names.size()) != references.cols()) {
    return fail("each reference needs a name and a finite force on each DOF");
  }
  if (values.rows() != num_lines() || values.cols() != num_pairs()) {
    return fail("expected a value for each line and pair");
  }
  for (Eigen::Index p = 0; p < num_pairs(); ++p) {
    Eigen::Index present = 0;
    for (Eigen::Index k = 0; k < num_lines(); ++k) {
      const double size = std::abs(values(k, p));
      if (std::isinf(size)) return fail("a value is not finite");
      present += std::isfinite(size) && size > 0.0 ? 1 : 0;
    }
    if (present < kFewestFrfLines) {
      return fail("pair " + PairName(p) +
                  " has fewer than 10 lines with a value that is not zero");
    }
  }
  if (variances.size() > 0 &&
      (variances.rows() != num_lines() || variances.cols() != num_pairs() ||
       !variances.allFinite() || !(variances.array() > 0.0).all())) {
    return fail("expected a positive variance for each line and pair");
  }
  if (sigma.size() > 0 && (sigma.size() != num_pairs() || !sigma.allFinite() ||
                           !(sigma.array() > 0.0).all())) {
    return fail("expected a positive standard deviation for each pair");
  }
  if (!AreValidIndices(gains, num_responses(), num_sensors) ||
      !AreValidIndices(delays, num_responses(), num_sensors) ||
      !AreValidIndices({loss_factor}, 1, num_sensors)) {
    return fail("a gain, delay or loss factor is no parameter of the sensors");
  }
  return true;
}

}  // namespace pinode
