#include "pinode/record/frf/frequency_responses.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Largest difference of two files' frequencies that are one line, in distances
// between lines.
constexpr double kSameLine = 0.01;
// Coherences are kept away from 0 and 1, where the variance has no meaning.
constexpr double kSmallestCoherence = 1e-6;
// Relative difference of the windows of two files that are the same: files
// round it to six digits or more.
constexpr double kSameWindow = 1e-5;

// Removes the sign of a place. Returns it.
double TakeSign(std::string* place) {
  const size_t colon = place->rfind(':');
  const size_t at = colon == std::string::npos ? 0 : colon + 1;
  if (at < place->size() && (*place)[at] == '-') {
    place->erase(at, 1);
    return -1.0;
  }
  return 1.0;
}

Eigen::Index AddPlace(const std::string& name,
                      std::vector<std::string>* names) {
  const auto found = std::find(names->begin(), names->end(), name);
  const auto at = found - names->begin();
  if (found == names->end()) names->push_back(name);
  return static_cast<Eigen::Index>(at);
}

bool IsAscending(const Vector& lines) {
  for (Eigen::Index k = 1; k < lines.size(); ++k) {
    if (!(lines[k] > lines[k - 1])) return false;
  }
  return lines.size() > 0 && lines[0] >= 0.0;
}

bool SameLines(const Vector& a, const Vector& b) {
  if (a.size() != b.size()) return false;
  for (Eigen::Index k = 0; k < a.size(); ++k) {
    const double step = k > 0 ? a[k] - a[k - 1] : a[1] - a[0];
    if (std::abs(a[k] - b[k]) > kSameLine * step) return false;
  }
  return true;
}

bool Check(const FrequencyResponse& one, const FrequencyResponse& first,
           std::string* what) {
  if (one.values.size() != one.frequencies_hz.size() || one.values.size() < 2 ||
      !IsAscending(one.frequencies_hz)) {
    *what = "its frequencies do not ascend, expected lines in Hz from 0 on";
  } else if (!one.frequencies_hz.allFinite()) {
    *what = "a frequency is infinite; leave its line out";
  } else if (!one.values.allFinite() || !one.coherence.allFinite()) {
    *what = "a value is missing or infinite; leave its line out";
  } else if (!SameLines(first.frequencies_hz, one.frequencies_hz)) {
    *what = "its lines are not those of " + first.file +
            ", expected the same frequencies; give it as another set-up";
  } else if (one.derivative < 0) {
    *what =
        "does not say what was measured; set the quantity (--frf_quantity) to "
        "acceleration, velocity or displacement";
  } else if (one.derivative != first.derivative) {
    *what = std::string("is a ") + FrfQuantityName(one.derivative) + ", but " +
            first.file + " a " + FrfQuantityName(first.derivative) +
            ", expected one quantity; give it as another set-up";
  } else if (std::abs(one.decay_rate - first.decay_rate) >
             kSameWindow * first.decay_rate) {
    *what = "was measured with another exponential window than " + first.file +
            "; give it as another set-up";
  } else if (one.response.empty() || one.reference.empty()) {
    *what =
        std::string("does not name the place of its ") +
        (one.response.empty() ? "response; set responses (--frf_responses)"
                              : "reference; set references (--frf_references)");
  } else {
    return true;
  }
  return false;
}

}  // namespace

const char* FrfQuantityName(int derivative) {
  return derivative == 0   ? "receptance"
         : derivative == 1 ? "mobility"
                           : "accelerance";
}

Matrix VariancesOfCoherence(const ComplexMatrix& values,
                            const Matrix& coherence) {
  const Eigen::ArrayXXd within = coherence.cwiseMax(kSmallestCoherence)
                                     .cwiseMin(1.0 - kSmallestCoherence)
                                     .array();
  return values.cwiseAbs2().array() * (1.0 - within) / within;
}

bool AssembleFrequencyResponses(const std::vector<FrequencyResponse>& single,
                                FrequencyResponses* all, std::string* error) {
  if (single.empty()) {
    *error = "no frequency response function was found";
    return false;
  }
  FrequencyResponses result;
  const FrequencyResponse& first = single.front();
  struct Place {
    Eigen::Index response, reference;
    double sign;
  };
  std::vector<Place> places;
  std::vector<std::string> files;
  bool has_coherence = true;
  for (const FrequencyResponse& one : single) {
    std::string what;
    if (!Check(one, first, &what)) {
      *error = one.file + ": " + what;
      return false;
    }
    std::string response = one.response;
    std::string reference = one.reference;
    const double sign = TakeSign(&response) * TakeSign(&reference);
    places.push_back({AddPlace(response, &result.responses),
                      AddPlace(reference, &result.references), sign});
    has_coherence = has_coherence && one.coherence.size() == one.values.size();
  }
  result.derivative = first.derivative;
  result.decay_rate = first.decay_rate;
  result.frequencies_hz = first.frequencies_hz;
  const Eigen::Index pairs = result.num_responses() * result.num_references();
  std::set<Eigen::Index> present;
  for (size_t i = 0; i < single.size(); ++i) {
    const FrequencyResponse& one = single[i];
    if (!present.insert(result.Pair(places[i].response, places[i].reference))
             .second) {
      *error = one.file + ": response '" + one.response + "' to reference '" +
               one.reference +
               "' occurs twice; leave one out, or give it as another set-up";
      return false;
    }
  }
  // Before the matrices, which many places without their pairs make huge.
  Eigen::Index complete = 0;
  while (present.count(complete) > 0) ++complete;
  if (complete < pairs) {
    const auto name = [](const std::vector<std::string>& names,
                         Eigen::Index i) {
      return names[static_cast<size_t>(i)];
    };
    *error = first.file + ": the response '" +
             name(result.responses, complete % result.num_responses()) +
             "' to reference '" +
             name(result.references, complete / result.num_responses()) +
             "' is missing, expected each response to each reference; give "
             "complete sets as set-ups of their own";
    return false;
  }
  result.values = ComplexMatrix::Zero(result.num_lines(), pairs);
  if (has_coherence) result.coherence = Matrix::Ones(result.num_lines(), pairs);
  result.files.assign(static_cast<size_t>(pairs), -1);
  for (size_t i = 0; i < single.size(); ++i) {
    const FrequencyResponse& one = single[i];
    const Eigen::Index pair =
        result.Pair(places[i].response, places[i].reference);
    result.files[static_cast<size_t>(pair)] =
        static_cast<int>(AddPlace(one.file, &files));
    result.values.col(pair) = places[i].sign * one.values;
    if (has_coherence) result.coherence.col(pair) = one.coherence;
  }
  if (has_coherence) {
    result.variances = VariancesOfCoherence(result.values, result.coherence);
  }
  *all = std::move(result);
  return true;
}

}  // namespace pinode
