#include "pinode/modal/merge_setups.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/modal/stabilisation.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;
using Shape = Eigen::VectorXcd;

// Tolerances for two set-ups' estimates of one mode. Their frequencies may
// differ by so many standard deviations, or by this fraction if traffic or
// temperature changes them. Shapes agree at the references.
constexpr double kSigmas = 4.0;
constexpr double kFraction = 0.01;
constexpr double kSmallestMac = 0.7;

int Find(const std::vector<std::string>& names, const std::string& name) {
  const auto place = std::find(names.begin(), names.end(), name);
  return place == names.end() ? -1 : static_cast<int>(place - names.begin());
}

Shape Entries(const Shape& shape, const std::vector<int>& rows) {
  Shape result(static_cast<Eigen::Index>(rows.size()));
  for (size_t i = 0; i < rows.size(); ++i) {
    result[static_cast<Eigen::Index>(i)] = shape[rows[i]];
  }
  return result;
}

class Merger {
 public:
  Merger(const std::vector<SetupModes>& setups, const MergeOptions& options,
         MergedModes* merged, std::string* error)
      : setups_(setups), options_(options), merged_(merged), error_(error) {}

  bool Merge() {
    *merged_ = MergedModes();
    for (const SetupModes& setup : setups_) {
      for (const std::string& place : setup.places) {
        if (Find(merged_->places, place) < 0) merged_->places.push_back(place);
      }
      used_.emplace_back(setup.modes.size(), false);
    }
    if (!FindReferences()) return false;
    while (true) {
      const std::vector<int> members = Gather();
      if (members.empty()) break;
      const auto seen = std::count_if(members.begin(), members.end(),
                                      [](int m) { return m >= 0; });
      if (2 * static_cast<size_t>(seen) >= setups_.size()) {
        merged_->modes.push_back(Combine(members));
      } else {
        RemarkOn(members);
      }
    }
    std::sort(merged_->modes.begin(), merged_->modes.end(),
              [](const MergedMode& a, const MergedMode& b) {
                return a.mode.frequency_hz < b.mode.frequency_hz;
              });
    return true;
  }

 private:
  const IdentifiedMode& mode(size_t setup, int number) const {
    return setups_[setup].modes[static_cast<size_t>(number)];
  }

  bool FindReferences() {
    std::vector<std::string> names = options_.references;
    if (names.empty()) {
      for (const std::string& place : setups_.front().places) {
        if (std::all_of(setups_.begin(), setups_.end(),
                        [&place](const SetupModes& setup) {
                          return Find(setup.places, place) >= 0;
                        })) {
          names.push_back(place);
        }
      }
    }
    if (names.empty()) {
      *error_ =
          "the records have no common place to join their shapes; use "
          "reference sensors that stay";
      return false;
    }
    for (const SetupModes& setup : setups_) {
      references_.emplace_back();
      for (const std::string& name : names) {
        const int row = Find(setup.places, name);
        if (row < 0) {
          *error_ =
              "reference '" + name + "' is not in record '" + setup.name + "'";
          return false;
        }
        references_.back().push_back(row);
      }
    }
    return true;
  }

  // Returns the most certain mode without a group, and the same mode in the
  // other set-ups.
  std::vector<int> Gather() {
    size_t base = 0;
    int seed = -1;
    for (size_t s = 0; s < setups_.size(); ++s) {
      for (size_t m = 0; m < setups_[s].modes.size(); ++m) {
        if (used_[s][m]) continue;
        const int number = static_cast<int>(m);
        if (seed < 0 ||
            Relative(mode(s, number)) < Relative(mode(base, seed))) {
          base = s;
          seed = number;
        }
      }
    }
    if (seed < 0) return {};
    std::vector<int> members(setups_.size(), -1);
    for (size_t s = 0; s < setups_.size(); ++s) {
      members[s] = s == base ? seed : Like(base, seed, s);
      if (members[s] >= 0) used_[s][static_cast<size_t>(members[s])] = true;
    }
    return members;
  }

  static double Relative(const IdentifiedMode& m) {
    return m.frequency_sigma / m.frequency_hz;
  }

  int Like(size_t base, int seed, size_t other) const {
    const IdentifiedMode& wanted = mode(base, seed);
    const Shape at = Entries(wanted.shape, references_[base]);
    int best = -1;
    double nearest = kInfinity;
    for (size_t m = 0; m < setups_[other].modes.size(); ++m) {
      if (used_[other][m]) continue;
      const IdentifiedMode& next = mode(other, static_cast<int>(m));
      const double apart = std::abs(next.frequency_hz - wanted.frequency_hz);
      const double sigma =
          std::hypot(next.frequency_sigma, wanted.frequency_sigma);
      if (apart > std::max(kSigmas * sigma, kFraction * wanted.frequency_hz)) {
        continue;
      }
      const double mac =
          ComplexMac(at, Entries(next.shape, references_[other]));
      if (references_[base].size() > 1 && mac < kSmallestMac) continue;
      const double distance = apart / wanted.frequency_hz + 0.05 * (1.0 - mac);
      if (distance < nearest) {
        nearest = distance;
        best = static_cast<int>(m);
      }
    }
    return best;
  }

  void RemarkOn(const std::vector<int>& members) {
    for (size_t s = 0; s < members.size(); ++s) {
      if (members[s] < 0) continue;
      merged_->remarks.push_back(
          "A mode at " + FormatNumber(mode(s, members[s]).frequency_hz, 5) +
          " Hz was found in record '" + setups_[s].name +
          "' and in fewer than half of the others. It is left out.");
    }
  }

  MergedMode Combine(const std::vector<int>& members) const {
    MergedMode result;
    result.in_setups = members;
    std::vector<size_t> seen;
    for (size_t s = 0; s < members.size(); ++s) {
      if (members[s] >= 0) seen.push_back(s);
    }
    size_t base = seen.front();
    for (const size_t s : seen) {
      if (Relative(mode(s, members[s])) < Relative(mode(base, members[base]))) {
        base = s;
      }
    }
    result.mode = mode(base, members[base]);
    CombineShapes(members, seen, base, &result.mode);
    if (seen.size() > 1) {
      CombineNumbers(members, seen, &result);
    }
    return result;
  }

  // Combines frequency and damping.
  void CombineNumbers(const std::vector<int>& members,
                      const std::vector<size_t>& seen,
                      MergedMode* result) const {
    const Eigen::Index count = static_cast<Eigen::Index>(seen.size());
    Matrix values(2, count);
    Matrix variances(2, count);
    double degrees = 0.0;
    for (Eigen::Index i = 0; i < count; ++i) {
      const size_t s = seen[static_cast<size_t>(i)];
      const IdentifiedMode& m = mode(s, members[s]);
      values.col(i) << m.frequency_hz, m.damping_ratio;
      variances.col(i) << std::pow(m.frequency_sigma, 2),
          std::pow(m.damping_sigma, 2);
      degrees += m.degrees_of_freedom;
    }
    IdentifiedMode& merged = result->mode;
    double means[2];
    double sigmas[2];
    double between[2];
    for (int q = 0; q < 2; ++q) {
      const Vector weights = variances.row(q).cwiseInverse();
      means[q] = values.row(q).dot(weights) / weights.sum();
      const Vector off = values.row(q).transpose().array() - means[q];
      const double scatter =
          weights.dot(off.cwiseAbs2()) / static_cast<double>(count - 1);
      sigmas[q] = std::sqrt(std::max(1.0, scatter) / weights.sum());
      between[q] =
          std::sqrt(off.squaredNorm() / static_cast<double>(count - 1));
    }
    // If set-ups differ by more than their standard deviations, their
    // covariance with the shape grows too.
    for (int q = 0; q < 2; ++q) {
      const double old = std::sqrt(merged.covariance(q, q));
      merged.covariance.row(q) *= sigmas[q] / old;
      merged.covariance.col(q) *= sigmas[q] / old;
    }
    merged.frequency_hz = means[0];
    merged.damping_ratio = means[1];
    merged.frequency_sigma = sigmas[0];
    merged.damping_sigma = sigmas[1];
    merged.degrees_of_freedom = degrees;
    result->frequency_between = between[0];
    result->damping_between = between[1];
    const double t = StudentQuantile(degrees);
    merged.frequency_lower95 = means[0] - t * sigmas[0];
    merged.frequency_upper95 = means[0] + t * sigmas[0];
    merged.damping_lower95 = std::max(0.0, means[1] - t * sigmas[1]);
    merged.damping_upper95 = means[1] + t * sigmas[1];
  }

  // Returns the share of each set-up in the mean frequency and the mean damping
  // ratio, see CombineNumbers.
  Matrix SharesOfNumbers(const std::vector<int>& members,
                         const std::vector<size_t>& seen) const {
    if (seen.size() == 1) return Matrix::Ones(2, 1);
    Matrix shares(2, static_cast<Eigen::Index>(seen.size()));
    for (size_t i = 0; i < seen.size(); ++i) {
      const IdentifiedMode& m = mode(seen[i], members[seen[i]]);
      shares.col(static_cast<Eigen::Index>(i))
          << 1.0 / std::pow(m.frequency_sigma, 2),
          1.0 / std::pow(m.damping_sigma, 2);
    }
    return shares.array().colwise() / shares.rowwise().sum().array();
  }

  // Returns the mean over all places of the set-ups' shapes, which follow each
  // other in `entries`.
  Shape MeanShape(const std::vector<int>& members,
                  const std::vector<size_t>& seen, size_t base,
                  const std::vector<Shape>& entries) const {
    Shape sums = Shape::Zero(static_cast<Eigen::Index>(merged_->places.size()));
    Vector weights = Vector::Zero(sums.size());
    size_t base_place = 0;
    while (seen[base_place] != base) ++base_place;
    const Shape wanted = Entries(entries[base_place], references_[base]);
    for (size_t i = 0; i < seen.size(); ++i) {
      const size_t s = seen[i];
      const Shape own = Entries(entries[i], references_[s]);
      const Complex scale =
          s == base ? Complex(1.0) : own.dot(wanted) / own.squaredNorm();
      const IdentifiedMode& m = mode(s, members[s]);
      const double size = std::abs(own.dot(wanted)) / own.squaredNorm();
      for (size_t p = 0; p < setups_[s].places.size(); ++p) {
        const Eigen::Index row = Find(merged_->places, setups_[s].places[p]);
        const Eigen::Index at = static_cast<Eigen::Index>(p);
        // Without a lower limit the reference entry, which is known exactly,
        // would have all the weight.
        const double sigma = size * (std::hypot(m.shape_sigma_real[at],
                                                m.shape_sigma_imaginary[at]) +
                                     1e-3);
        const double weight = 1.0 / (sigma * sigma);
        sums[row] += weight * scale * entries[i][at];
        weights[row] += weight;
      }
    }
    for (Eigen::Index row = 0; row < sums.size(); ++row) {
      sums[row] =
          weights[row] > 0.0 ? sums[row] / weights[row] : Complex(kNaN, kNaN);
    }
    return sums;
  }

  // Returns real parts above imaginary parts, scaled to one at the largest
  // entry `largest`. A negative `largest` is replaced by its position.
  static Vector Parts(const Shape& shape, Eigen::Index* largest) {
    if (*largest < 0) {
      double size = 0.0;
      for (Eigen::Index i = 0; i < shape.size(); ++i) {
        if (std::abs(shape[i]) > size) {
          size = std::abs(shape[i]);
          *largest = i;
        }
      }
    }
    const Shape scaled = shape / shape[*largest];
    Vector parts(2 * shape.size());
    parts << scaled.real(), scaled.imag();
    return parts;
  }

  // Computes the mean shape and, by differences, its covariance.
  void CombineShapes(const std::vector<int>& members,
                     const std::vector<size_t>& seen, size_t base,
                     IdentifiedMode* merged) const {
    std::vector<Shape> entries;
    for (const size_t s : seen) entries.push_back(mode(s, members[s]).shape);
    Eigen::Index largest = -1;
    const Vector parts =
        Parts(MeanShape(members, seen, base, entries), &largest);
    const Eigen::Index places = parts.size() / 2;
    Matrix covariance = Matrix::Zero(2 + parts.size(), 2 + parts.size());
    const Matrix shares = SharesOfNumbers(members, seen);
    constexpr double kStep = 1e-6;
    for (size_t i = 0; i < seen.size(); ++i) {
      const IdentifiedMode& m = mode(seen[i], members[seen[i]]);
      const Eigen::Index count = m.shape.size();
      Matrix slopes = Matrix::Zero(2 + parts.size(), 2 + 2 * count);
      for (Eigen::Index k = 0; k < 2 * count; ++k) {
        std::vector<Shape> moved = entries;
        moved[i][k % count] += k < count ? Complex(kStep) : Complex(0, kStep);
        slopes.col(2 + k).tail(parts.size()) =
            (Parts(MeanShape(members, seen, base, moved), &largest) - parts) /
            kStep;
      }
      slopes.topLeftCorner(2, 2) =
          shares.col(static_cast<Eigen::Index>(i)).asDiagonal();
      covariance += slopes * m.covariance * slopes.transpose();
    }
    merged->shape.resize(places);
    merged->shape.real() = parts.head(places);
    merged->shape.imag() = parts.tail(places);
    merged->covariance = covariance;
    const Vector sigmas = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    merged->shape_sigma_real = sigmas.segment(2, places);
    merged->shape_sigma_imaginary = sigmas.tail(places);
  }

  const std::vector<SetupModes>& setups_;
  const MergeOptions& options_;
  MergedModes* merged_;
  std::string* error_;
  std::vector<std::vector<int>> references_;  // per set-up rows of its shapes
  std::vector<std::vector<bool>> used_;
};

}  // namespace

bool MergeSetups(const std::vector<SetupModes>& setups,
                 const MergeOptions& options, MergedModes* merged,
                 std::string* error) {
  if (setups.size() == 1) {
    *merged = MergedModes();
    merged->places = setups[0].places;
    for (size_t m = 0; m < setups[0].modes.size(); ++m) {
      merged->modes.push_back(
          {setups[0].modes[m], {static_cast<int>(m)}, 0, 0});
    }
    return true;
  }
  return Merger(setups, options, merged, error).Merge();
}

}  // namespace pinode
