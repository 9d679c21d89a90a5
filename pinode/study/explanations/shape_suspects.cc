#include "pinode/study/explanations/shape_suspects.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"
#include "pinode/estimate/objective/modal_cost.h"
#include "pinode/structure/model/modal_analysis.h"
#include "pinode/study/explanations/ungrouped_stiffness.h"

namespace pinode {
namespace {

using Kind = Suspect::Kind;
using ShapeChange = Suspect::ShapeChange;

// Number of places up to which pairs of them are compared.
constexpr size_t kMostComparedPlaces = 60;
// Number of modes up to which the sign of each entry is turned.
constexpr size_t kMostComparedModes = 20;
// Gain of likeness from which a fault is worth a refit: a MAC of 0.98 that
// becomes 1.
constexpr double kLeastLikeness = 0.02;
// Smallest change of a gain that is worth a refit.
constexpr double kLeastGain = 0.05;
// Smallest correlation of measured and predicted entries of a wrong gain.
constexpr double kLeastCorrelation = 0.9;

// Position of a DOF in a shape; -1: not measured.
int PositionOf(int dof, const MeasuredMode& mode) {
  const auto found = std::find(mode.dofs.begin(), mode.dofs.end(), dof);
  return found == mode.dofs.end() ? -1
                                  : static_cast<int>(found - mode.dofs.begin());
}

void ScaleEntry(int dof, double factor, MeasuredMode* mode) {
  const int at = PositionOf(dof, *mode);
  if (at < 0) return;
  mode->shape[at] *= factor;
  // One standard deviation is no longer that of all entries.
  if (mode->shape_sigma > 0.0 && std::abs(factor) != 1.0) {
    const double variance = mode->shape_sigma * mode->shape_sigma;
    mode->shape_covariance =
        variance * Matrix::Identity(mode->shape.size(), mode->shape.size());
    mode->shape_sigma = 0.0;
  }
  if (mode->shape_covariance.size() > 0) {
    mode->shape_covariance.row(at) *= factor;
    mode->shape_covariance.col(at) *= factor;
  }
  if (mode->frequency_shape_covariance.size() > 0) {
    mode->frequency_shape_covariance[at] *= factor;
  }
}

// Frequencies and what is known of them stay.
void ExchangeShapes(MeasuredMode* one, MeasuredMode* two) {
  std::swap(one->dofs, two->dofs);
  std::swap(one->shape, two->shape);
  std::swap(one->shape_sigma, two->shape_sigma);
  std::swap(one->shape_weight, two->shape_weight);
  std::swap(one->shape_covariance, two->shape_covariance);
  one->frequency_shape_covariance.resize(0);
  two->frequency_shape_covariance.resize(0);
}

// Modes of M and K with their groups at `parameters`; false if there are none.
bool ModesAt(const IdentificationProblem& problem, const Vector& parameters,
             UndampedModes* modes) {
  const StructuralDynamics dynamics =
      AveragedDynamics(problem.modal, *problem.dynamics);
  const StructuralModel corrected =
      dynamics.CorrectedModel(parameters.head(dynamics.num_parameters()));
  std::string unused;
  return corrected.mass.allFinite() && corrected.stiffness.allFinite() &&
         ComputeUndampedModes(corrected.mass, corrected.stiffness, modes,
                              &unused);
}

double LikenessTo(const UndampedModes& modes, const ModalData& data) {
  std::vector<double> stretches;
  double sum = 0.0;
  const std::vector<ModeMatch> matches =
      MatchModes(data, modes.eigenvalues, modes.shapes);
  for (size_t i = 0; i < matches.size(); ++i) {
    if (data.modes[i].HasShape()) sum += matches[i].mac;
    const double ratio = matches[i].frequency / data.modes[i].frequency;
    // A mode without stiffness is as unlike as one off by a factor of e.
    stretches.push_back(ratio > 0.0 ? std::clamp(std::log(ratio), -1.0, 1.0)
                                    : -1.0);
  }
  const double median = Median(stretches);
  for (const double stretch : stretches) {
    sum -= 0.5 * (stretch - median) * (stretch - median);
  }
  return sum;
}

// Faults of one kind.
struct RankedSuspects {
  size_t num_compared = 0;
  std::vector<std::pair<double, Suspect>> better;  // by likeness gained
};

// Compares changed modes with those of several models.
class ShapeScreen {
 public:
  ShapeScreen(const IdentificationProblem& problem, const Vector& fitted)
      : problem_(problem) {
    for (const Vector& parameters :
         {Vector(problem.dynamics->Parameters()), fitted}) {
      UndampedModes modes;
      if (!ModesAt(problem, parameters, &modes)) continue;
      before_.push_back(LikenessTo(modes, problem.modal));
      modes_.push_back(std::move(modes));
    }
  }

  void Offer(const ShapeChange& change, Suspect suspect,
             RankedSuspects* ranked) const {
    ++ranked->num_compared;
    ModalData changed = problem_.modal;
    ChangeShapes({change}, &changed);
    double better = 0.0;
    for (size_t i = 0; i < modes_.size(); ++i) {
      better = std::max(better, LikenessTo(modes_[i], changed) - before_[i]);
    }
    if (better < kLeastLikeness) return;
    suspect.shape_changes = {change};
    ranked->better.emplace_back(better, std::move(suspect));
  }

 private:
  const IdentificationProblem& problem_;
  std::vector<UndampedModes> modes_;
  std::vector<double> before_;
};

void TakeBest(size_t most, RankedSuspects* ranked,
              std::vector<Suspect>* suspects) {
  auto& better = ranked->better;
  std::stable_sort(
      better.begin(), better.end(),
      [](const auto& a, const auto& b) { return a.first > b.first; });
  if (better.size() > most) better.resize(most);
  for (auto& [unused, suspect] : better) {
    suspect.num_compared = ranked->num_compared;
    suspects->push_back(std::move(suspect));
  }
  better.clear();
}

std::string NameOfMode(const ModalData& data, size_t i) {
  return data.modes[i].name.empty() ? std::to_string(i + 1)
                                    : data.modes[i].name;
}

Suspect Named(Kind kind, std::string place, std::string what) {
  Suspect suspect;
  suspect.kind = kind;
  suspect.place = std::move(place);
  suspect.what = std::move(what);
  return suspect;
}

}  // namespace

void ChangeShapes(const std::vector<ShapeChange>& changes, ModalData* data) {
  for (const ShapeChange& change : changes) {
    if (change.kind == ShapeChange::Kind::kExchangeModes) {
      ExchangeShapes(&data->modes[static_cast<size_t>(change.one)],
                     &data->modes[static_cast<size_t>(change.two)]);
      continue;
    }
    for (size_t i = 0; i < data->modes.size(); ++i) {
      if (change.mode >= 0 && change.mode != static_cast<int>(i)) continue;
      MeasuredMode& mode = data->modes[i];
      if (change.kind == ShapeChange::Kind::kScale) {
        ScaleEntry(change.one, change.factor, &mode);
        continue;
      }
      for (int& dof : mode.dofs) {
        if (dof == change.one) {
          dof = change.two;
        } else if (dof == change.two) {
          dof = change.one;
        }
      }
    }
  }
}

void LeaveOutPlace(int dof, ModalData* data) {
  for (MeasuredMode& mode : data->modes) {
    const int at = PositionOf(dof, mode);
    if (at < 0 || mode.dofs.size() < 3) continue;
    std::vector<int> kept;
    for (int i = 0; i < static_cast<int>(mode.dofs.size()); ++i) {
      if (i != at) kept.push_back(i);
    }
    mode.dofs.erase(mode.dofs.begin() + at);
    mode.shape = Vector(mode.shape(kept));
    if (mode.shape_covariance.size() > 0) {
      mode.shape_covariance = Matrix(mode.shape_covariance(kept, kept));
    }
    if (mode.frequency_shape_covariance.size() > 0) {
      mode.frequency_shape_covariance =
          Vector(mode.frequency_shape_covariance(kept));
    }
  }
}

std::vector<int> MeasuredPlaces(const ModalData& data) {
  std::set<int> places;
  for (const MeasuredMode& mode : data.modes) {
    places.insert(mode.dofs.begin(), mode.dofs.end());
  }
  return {places.begin(), places.end()};
}

std::vector<Suspect> MakeShapeSuspects(const IdentificationProblem& problem,
                                       const IdentifiedModel& model,
                                       size_t most) {
  const ModalData& data = problem.modal;
  const StructuralModel& structure = problem.dynamics->model();
  const std::vector<int> places = MeasuredPlaces(data);
  std::vector<Suspect> suspects;
  if (places.size() < 2 || places.size() > kMostComparedPlaces ||
      data.modes.size() > kMostComparedModes ||
      static_cast<int>(data.modes.size()) > problem.dynamics->num_dofs()) {
    return suspects;
  }
  const ShapeScreen screen(problem, model.parameters);
  RankedSuspects turns, signs, exchanges, shapes;
  for (const int one : places) {
    const std::string name = PlaceName(structure, one);
    ShapeChange change;
    change.one = one;
    change.factor = -1.0;
    screen.Offer(change,
                 Named(Kind::kSensorGain, name,
                       "the sensor at '" + name + "' mounted upside down"),
                 &turns);
    for (size_t i = 0; i < data.modes.size(); ++i) {
      change.mode = static_cast<int>(i);
      const std::string mode = NameOfMode(data, i);
      screen.Offer(change,
                   Named(Kind::kMode, mode,
                         "the sign of mode " + mode + " at '" + name + "'"),
                   &signs);
    }
    change = {};
    change.kind = ShapeChange::Kind::kExchangeDofs;
    change.one = one;
    for (const int two : places) {
      if (two <= one) continue;
      change.two = two;
      const std::string other = PlaceName(structure, two);
      screen.Offer(
          change,
          Named(Kind::kExchange, name + "," + other,
                "the sensors at '" + name + "' and '" + other + "' swapped"),
          &exchanges);
    }
  }
  for (size_t i = 0; i < data.modes.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (!data.modes[i].HasShape() || !data.modes[j].HasShape()) continue;
      ShapeChange change;
      change.kind = ShapeChange::Kind::kExchangeModes;
      change.one = static_cast<int>(j);
      change.two = static_cast<int>(i);
      const std::string first = NameOfMode(data, j);
      const std::string second = NameOfMode(data, i);
      screen.Offer(
          change,
          Named(Kind::kMode, first + "," + second,
                "the shapes of modes " + first + " and " + second + " swapped"),
          &shapes);
    }
  }
  for (auto* ranked : {&turns, &signs, &exchanges, &shapes}) {
    TakeBest(most, ranked, &suspects);
  }
  return suspects;
}

std::optional<Suspect> MakeGainOfShapes(const IdentificationProblem& problem,
                                        const Vector& parameters, int dof) {
  UndampedModes modes;
  const ModalData& data = problem.modal;
  if (static_cast<int>(data.modes.size()) > problem.dynamics->num_dofs() ||
      !ModesAt(problem, parameters, &modes)) {
    return std::nullopt;
  }
  ModalData without = data;
  LeaveOutPlace(dof, &without);
  const std::vector<ModeMatch> matches =
      MatchModes(without, modes.eigenvalues, modes.shapes);
  double both = 0.0, predicted = 0.0, own = 0.0;
  for (size_t i = 0; i < data.modes.size(); ++i) {
    const MeasuredMode& mode = data.modes[i];
    const int at = PositionOf(dof, mode);
    if (at < 0 || mode.dofs.size() < 3 || matches[i].mode < 0) continue;
    const Vector others = modes.shapes(without.modes[i].dofs, matches[i].mode);
    const Vector& measured = without.modes[i].shape;
    if (!(others.squaredNorm() > 0.0) || !(measured.squaredNorm() > 0.0)) {
      continue;
    }
    const double scale = measured.dot(others) / others.squaredNorm();
    const double p = scale * modes.shapes(dof, matches[i].mode);
    const double y = mode.shape[at];
    // Shapes may have any scale.
    both += y * p / measured.squaredNorm();
    predicted += p * p / measured.squaredNorm();
    own += y * y / measured.squaredNorm();
  }
  if (!(predicted > 0.0) || !(own > 0.0)) return std::nullopt;
  const double gain = both / predicted;
  if (!(gain > 0.0) || std::abs(gain - 1.0) < kLeastGain ||
      both / std::sqrt(own * predicted) < kLeastCorrelation) {
    return std::nullopt;
  }
  const std::string name = PlaceName(problem.dynamics->model(), dof);
  Suspect suspect = Named(
      Kind::kSensorGain, name,
      "the gain of the sensor at '" + name + "', " + FormatNumber(gain, 3));
  ShapeChange change;
  change.one = dof;
  change.factor = 1.0 / gain;
  suspect.shape_changes = {change};
  return suspect;
}

}  // namespace pinode
