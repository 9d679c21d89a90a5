#include "pinode/study/explanations/ambient_suspects.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "pinode/base/strings.h"
#include "pinode/estimate/ambient/ambient_cost.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {
namespace {

using Kind = Suspect::Kind;

// Smallest change of a scale that is worth a refit.
constexpr double kLeastScale = 0.05;

// The lines of a record at a fit: sums over them of what sensors would change.
class LinesAtFit {
 public:
  // False if the model fails there.
  bool Sum(const IdentificationProblem& problem, const IdentifiedModel& model,
           size_t record, int num_threads) {
    const ParameterLayout layout(problem);
    if (model.parameters.size() != layout.num_parameters()) return false;
    AmbientCost cost(problem.ambient[record], *problem.dynamics, layout,
                     num_threads);
    if (!cost.SetPoint(layout.Free(model.parameters))) return false;
    cost.CompleteTransfer();
    const AmbientLoads& loads = cost.loads();
    const std::vector<Matrix> knots = loads.KnotCovariances();
    const Eigen::Index size = loads.num_channels();
    like_ = Matrix::Zero(size, size);
    cross_ = Matrix::Zero(size, size);
    own_ = with_predicted_ = predicted_ = Vector::Zero(size);
    for (Eigen::Index line = 0; line < cost.lines().size(); ++line) {
      ComplexFactor factor;
      const Matrix covariance =
          loads.Covariance(cost.lines().frequency(line), knots);
      if (!cost.likelihood().FactorizeLine(line, loads, covariance, &factor)) {
        return false;
      }
      Add(factor.solve(Eigen::MatrixXcd::Identity(size, size)),
          cost.lines().products(line));
    }
    return true;
  }

  // Gain of the log-likelihood if channels a and b change places.
  double GainOfExchange(Eigen::Index a, Eigen::Index b) const {
    return like_(std::max(a, b), std::min(a, b));
  }
  double GainOfTurn(Eigen::Index c) const {
    return 4.0 * (cross_.row(c).sum() - cross_(c, c));
  }
  // Regression of a channel on its prediction; NaN if it is not predicted.
  double ScaleOf(Eigen::Index c) const {
    return predicted_[c] > 0.0 ? with_predicted_[c] / predicted_[c] : kNaN;
  }
  double CorrelationOf(Eigen::Index c) const {
    const double size = own_[c] * predicted_[c];
    return size > 0.0 ? with_predicted_[c] / std::sqrt(size) : 0.0;
  }
  Eigen::Index size() const { return own_.size(); }

 private:
  void Add(const Eigen::MatrixXcd& inverse, const Eigen::MatrixXcd& products) {
    const Eigen::Index n = own_.size();
    const Eigen::MatrixXcd both = inverse * products;
    const Eigen::MatrixXcd residual = both * inverse;
    for (Eigen::Index c = 0; c < n; ++c) {
      const double weight = inverse(c, c).real();
      const double own = products(c, c).real();
      const double along = both(c, c).real() / weight;
      own_[c] += weight * own;
      with_predicted_[c] += weight * (own - along);
      predicted_[c] +=
          weight * (own - 2.0 * along) + residual(c, c).real() / weight;
    }
    cross_ += (inverse.array() * products.transpose().array()).real().matrix();
    Eigen::MatrixXcd moved;
    for (Eigen::Index a = 0; a < n; ++a) {
      for (Eigen::Index b = 0; b < a; ++b) {
        moved = products;
        moved.row(a).swap(moved.row(b));
        moved.col(a).swap(moved.col(b));
        like_(a, b) +=
            (inverse.array() * (products - moved).transpose().array())
                .real()
                .sum();
      }
    }
  }

  Matrix like_;   // gain of each exchange, below the diagonal
  Matrix cross_;  // P_ij Y_j Y_i*
  Vector own_, with_predicted_, predicted_;
};

void KeepBest(std::vector<std::pair<double, Suspect>>* ranked, size_t most,
              std::vector<Suspect>* suspects) {
  std::stable_sort(
      ranked->begin(), ranked->end(),
      [](const auto& a, const auto& b) { return a.first > b.first; });
  if (ranked->size() > most) ranked->resize(most);
  for (auto& [unused, suspect] : *ranked) {
    suspects->push_back(std::move(suspect));
  }
}

// Returns the ambient record that a suspect changes.
int RecordOf(const Suspect& suspect) {
  return suspect.ambient_exchanged.empty()
             ? suspect.ambient_scales.front().record
             : suspect.ambient_exchanged.front().record;
}

// Adds the suspects of record `r` that are likeliest at `lines`. A gain is a
// regression on the prediction, which only a fit has.
void AddSuspectsAt(const LinesAtFit& lines, const AmbientRecord& record, int r,
                   bool is_fit, size_t most, std::vector<Suspect>* suspects) {
  std::vector<std::pair<double, Suspect>> exchanges, turns, scales;
  for (int c = 0; c < static_cast<int>(lines.size()); ++c) {
    const Observation& own = record.channels[static_cast<size_t>(c)];
    Suspect suspect;
    suspect.kind = Kind::kSensorGain;
    suspect.place = own.name;
    if (lines.GainOfTurn(c) > 0.0) {
      suspect.what = "sensor '" + own.name + "' mounted upside down";
      suspect.ambient_scales = {{r, c, -1.0}};
      turns.emplace_back(lines.GainOfTurn(c), suspect);
    }
    const double scale = lines.ScaleOf(c);
    if (is_fit && scale > 0.0 && std::abs(scale - 1.0) > kLeastScale) {
      suspect.what = "the gain of sensor '" + own.name + "'";
      suspect.ambient_scales = {{r, c, 1.0 / scale}};
      scales.emplace_back(std::abs(std::log(scale)) * lines.CorrelationOf(c),
                          suspect);
    }
    for (int d = 0; d < c; ++d) {
      const Observation& other = record.channels[static_cast<size_t>(d)];
      const double gain = lines.GainOfExchange(c, d);
      if (other.quantity != own.quantity || !(gain > 0.0)) continue;
      Suspect swapped;
      swapped.kind = Kind::kExchange;
      swapped.place = other.name + "," + own.name;
      swapped.what =
          "sensors '" + other.name + "' and '" + own.name + "' swapped";
      swapped.ambient_exchanged = {{r, d, c}};
      exchanges.emplace_back(gain, std::move(swapped));
    }
  }
  KeepBest(&exchanges, most, suspects);
  KeepBest(&turns, most, suspects);
  KeepBest(&scales, most, suspects);
}

}  // namespace

std::vector<Suspect> MakeAmbientSuspects(const IdentificationProblem& problem,
                                         const IdentifiedModel& model,
                                         int num_threads, size_t most) {
  std::vector<Suspect> suspects;
  // A fit may have adapted to a wrong sensor, or have lost itself.
  IdentifiedModel initial = model;
  initial.parameters = ParameterLayout(problem).InitialValues();
  for (size_t r = 0; r < problem.ambient.size(); ++r) {
    std::vector<Suspect> found;
    for (const IdentifiedModel* at :
         {static_cast<const IdentifiedModel*>(&initial), &model}) {
      LinesAtFit lines;
      if (!lines.Sum(problem, *at, r, num_threads)) continue;
      AddSuspectsAt(lines, problem.ambient[r], static_cast<int>(r),
                    at == &model, most, &found);
    }
    for (Suspect& suspect : found) {
      const bool is_known = std::any_of(
          suspects.begin(), suspects.end(), [&](const Suspect& other) {
            return other.what == suspect.what &&
                   other.ambient_exchanged.empty() ==
                       suspect.ambient_exchanged.empty() &&
                   RecordOf(other) == RecordOf(suspect);
          });
      if (!is_known) suspects.push_back(std::move(suspect));
    }
  }
  return suspects;
}

double AmbientScale(const IdentificationProblem& problem,
                    const IdentifiedModel& model, int record, int channel,
                    int num_threads) {
  LinesAtFit lines;
  if (!lines.Sum(problem, model, static_cast<size_t>(record), num_threads)) {
    return 1.0;
  }
  const double scale = lines.ScaleOf(channel);
  return scale > 0.0 ? 1.0 / scale : 1.0;
}

}  // namespace pinode
