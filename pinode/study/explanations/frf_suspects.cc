#include "pinode/study/explanations/frf_suspects.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <string>
#include <utility>

#include "pinode/estimate/frf/frf_transfer.h"
#include "pinode/problem/parameter_layout.h"

namespace pinode {
namespace {

using Eigen::Index;
using Kind = Suspect::Kind;

// Sampling rate behind the lines, in parts of the highest one, as analysers
// have it.
constexpr double kRateOfLines = 2.56;
// Widest delay that is looked for, in steps of that rate.
constexpr double kMostFrfDelay = 50.0;

// Columns of a response, or of a reference.
std::vector<Index> PairsOf(const FrfRecord& record, bool of_forces,
                           Index place) {
  std::vector<Index> pairs;
  const Index others =
      of_forces ? record.num_responses() : record.num_references();
  for (Index i = 0; i < others; ++i) {
    pairs.push_back(of_forces ? i + record.num_responses() * place
                              : place + record.num_responses() * i);
  }
  return pairs;
}

// Sums over the functions of each place (a response or a reference) of their
// correlations with those of the model.
struct Agreement {
  Vector own;      // at the same place
  Matrix crossed;  // at each place of the model (columns); may be empty
};

// Correlations are over the lines that are present in the measured function.
Agreement AgreementOf(const FrfRecord& record, const ComplexMatrix& modelled,
                      bool of_forces) {
  // Exchanges among more places than these take too long to compare.
  constexpr Index kMostPlaces = 500;
  const Index places =
      of_forces ? record.num_references() : record.num_responses();
  const Index others = record.num_pairs() / places;
  Agreement agreement;
  agreement.own = Vector::Zero(places);
  if (places <= kMostPlaces) agreement.crossed = Matrix::Zero(places, places);
  for (Index other = 0; other < others; ++other) {
    const std::vector<Index> pairs = PairsOf(record, !of_forces, other);
    ComplexMatrix measured = record.values(Eigen::all, pairs);
    const ComplexMatrix expected = modelled(Eigen::all, pairs);
    const Matrix present =
        measured.cwiseAbs().array().isFinite().cast<double>();
    measured = (present.array() > 0.0).select(measured, 0.0);
    const Vector sizes = measured.colwise().norm().transpose().cwiseMax(1e-300);
    const auto correlation = [&sizes](double product, double square, Index c) {
      return square > 0.0 ? product / (sizes[c] * std::sqrt(square)) : 0.0;
    };
    for (Index c = 0; c < places; ++c) {
      agreement.own[c] +=
          correlation(measured.col(c).dot(expected.col(c)).real(),
                      present.col(c).dot(expected.col(c).cwiseAbs2()), c);
    }
    if (places > kMostPlaces) continue;
    const Matrix products = (measured.adjoint() * expected).real();
    const Matrix squares = present.transpose() * expected.cwiseAbs2();
    for (Index c = 0; c < places; ++c) {
      for (Index d = 0; d < places; ++d) {
        agreement.crossed(c, d) +=
            correlation(products(c, d), squares(c, d), c);
      }
    }
  }
  return agreement;
}

// Functions of the model at the free parameters; no rows if it has none.
ComplexMatrix ModelledFrfs(const IdentificationProblem& problem,
                           const FrfRecord& record, const Vector& all) {
  const ParameterLayout layout(problem);
  if (all.size() != layout.num_parameters()) return {};
  FrfTransfer transfer(record, *problem.dynamics, layout);
  std::string unused;
  if (!transfer.SetPoint(layout.Free(all), &unused)) return {};
  ComplexMatrix values(record.num_lines(), record.num_pairs());
  FrfTransfer::Line line;
  for (Index k = 0; k < record.num_lines(); ++k) {
    transfer.Compute(k, /*with_slopes=*/false, &line);
    values.row(k) = line.values.transpose();
  }
  return values;
}

class FrfCatalogue {
 public:
  FrfCatalogue(const IdentificationProblem& problem,
               const IdentifiedModel& model, size_t most)
      : problem_(problem), model_(model), most_(most) {}

  std::vector<Suspect> Make() {
    AddSensors();
    for (size_t r = 0; r < problem_.frfs.size(); ++r) AddPlaces(r);
    return std::move(suspects_);
  }

 private:
  // Gains and delays that the problem has as unknowns are no suspects.
  void AddSensors() {
    std::map<std::string, std::vector<std::pair<int, int>>> sensors;
    std::vector<std::pair<int, int>> all;
    bool any_gain = false, any_delay = false;
    double highest = 0.0;
    for (size_t r = 0; r < problem_.frfs.size(); ++r) {
      const FrfRecord& record = problem_.frfs[r];
      highest = std::max(highest, record.frequencies.maxCoeff());
      for (size_t o = 0; o < record.responses.size(); ++o) {
        any_gain = any_gain || (!record.gains.empty() && record.gains[o] >= 0);
        any_delay =
            any_delay || (!record.delays.empty() && record.delays[o] >= 0);
        all.emplace_back(static_cast<int>(r), static_cast<int>(o));
        sensors[record.responses[o].name].push_back(all.back());
      }
    }
    if (!any_gain) AddGains(sensors, all);
    if (!any_delay && highest > 0.0) {
      AddDelays(sensors, all, 1.0 / (kRateOfLines * highest));
    }
  }

  void AddGains(
      const std::map<std::string, std::vector<std::pair<int, int>>>& sensors,
      const std::vector<std::pair<int, int>>& all) {
    Suspect& scale =
        Add(Kind::kExcitationScale, "",
            "all sensors by one factor (or the force by its inverse)");
    scale.sensors = {GainOf("sensors", all)};
    if (sensors.size() < 2) return;
    for (const auto& [name, unused] : sensors) {
      scale.tied.push_back(GainOf(name, {}).parameter.name);
    }
    for (const auto& [name, at] : sensors) {
      Add(Kind::kSensorGain, name, "the gain of sensor '" + name + "'")
          .sensors = {GainOf(name, at)};
    }
  }

  void AddDelays(
      const std::map<std::string, std::vector<std::pair<int, int>>>& sensors,
      const std::vector<std::pair<int, int>>& all, double step) {
    Suspect& late = Add(Kind::kExcitationDelay, "",
                        "the clock of all sensors against the force");
    late.sensors = {DelayOf("sensors", all, step)};
    late.usual = step;
    if (sensors.size() < 2) return;
    for (const auto& [name, unused] : sensors) {
      late.tied.push_back(DelayOf(name, {}, step).parameter.name);
    }
    for (const auto& [name, at] : sensors) {
      Suspect& own =
          Add(Kind::kSensorDelay, name, "the clock of sensor '" + name + "'");
      own.sensors = {DelayOf(name, at, step)};
      own.usual = step;
    }
  }

  Suspect::SensorUnknown DelayOf(const std::string& name,
                                 const std::vector<std::pair<int, int>>& at,
                                 double step) const {
    Suspect::SensorUnknown delay;
    delay.role = &MeasuredChannel::delay;
    delay.parameter.name = SuspectUnknown("delay.frf." + name);
    delay.parameter.unit = problem_.description.units.time;
    delay.parameter.lower = -kMostFrfDelay * step;
    delay.parameter.upper = kMostFrfDelay * step;
    delay.frf_responses = at;
    return delay;
  }

  static Suspect::SensorUnknown GainOf(
      const std::string& name, const std::vector<std::pair<int, int>>& at) {
    Suspect::SensorUnknown gain = UnknownGain("frf." + name, {});
    gain.frf_responses = at;
    return gain;
  }

  Suspect& Add(Kind kind, const std::string& place, const std::string& what) {
    Suspect suspect;
    suspect.kind = kind;
    suspect.place = place;
    suspect.what = what;
    suspects_.push_back(std::move(suspect));
    return suspects_.back();
  }

  // Change of two places, or of one that is turned round.
  struct Change {
    double gain = 0.0;
    Index one = 0;
    Index two = 0;
  };

  void AddPlaces(size_t r) {
    const FrfRecord& record = problem_.frfs[r];
    std::vector<ComplexMatrix> models;
    const Vector initial = ParameterLayout(problem_).InitialValues();
    for (const Vector& at : {model_.parameters, initial}) {
      ComplexMatrix modelled = ModelledFrfs(problem_, record, at);
      if (modelled.rows() == 0 || !modelled.allFinite()) continue;
      models.push_back(std::move(modelled));
    }
    for (const bool of_forces : {false, true}) {
      std::vector<Agreement> agreements;
      for (const ComplexMatrix& modelled : models) {
        agreements.push_back(AgreementOf(record, modelled, of_forces));
      }
      std::vector<Change> turns, exchanges;
      const Index count =
          of_forces ? record.num_references() : record.num_responses();
      for (Index d = 0; d < count; ++d) {
        const double turn = TurnGain(agreements, d);
        if (turn > 0.0) turns.push_back({turn, d, d});
        for (Index c = 0; c < d; ++c) {
          if (!of_forces && !SameQuantity(record, c, d)) continue;
          const double exchange = ExchangeGain(agreements, c, d);
          if (exchange > 0.0) exchanges.push_back({exchange, c, d});
        }
      }
      AddLikeliest(r, of_forces, &turns);
      AddLikeliest(r, of_forces, &exchanges);
    }
  }

  static bool SameQuantity(const FrfRecord& record, Index c, Index d) {
    return record.responses[static_cast<size_t>(c)].quantity ==
           record.responses[static_cast<size_t>(d)].quantity;
  }

  static double TurnGain(const std::vector<Agreement>& agreements, Index c) {
    double gain = 0.0;
    for (const Agreement& agreement : agreements) {
      gain = std::max(gain, -2.0 * agreement.own[c]);
    }
    return gain;
  }

  static double ExchangeGain(const std::vector<Agreement>& agreements, Index c,
                             Index d) {
    double gain = 0.0;
    for (const Agreement& agreement : agreements) {
      const Matrix& crossed = agreement.crossed;
      if (crossed.size() == 0) continue;
      gain = std::max(gain, crossed(c, d) + crossed(d, c) - agreement.own[c] -
                                agreement.own[d]);
    }
    return gain;
  }

  void AddLikeliest(size_t r, bool of_forces, std::vector<Change>* changes) {
    std::stable_sort(
        changes->begin(), changes->end(),
        [](const Change& a, const Change& b) { return a.gain > b.gain; });
    if (changes->size() > most_) changes->resize(most_);
    for (const Change& change : *changes) AddChange(r, of_forces, change);
  }

  void AddChange(size_t r, bool of_forces, const Change& change) {
    const std::string first = NameOf(problem_.frfs[r], of_forces, change.one);
    const std::string second = NameOf(problem_.frfs[r], of_forces, change.two);
    Suspect* suspect = nullptr;
    if (change.one == change.two) {
      suspect =
          &Add(of_forces ? Kind::kExcitationScale : Kind::kSensorGain, first,
               of_forces ? "the force at '" + first + "' in the other direction"
                         : "sensor '" + first + "' mounted upside down");
    } else {
      suspect = &Add(of_forces ? Kind::kForcePlace : Kind::kExchange,
                     first + "," + second,
                     (of_forces ? "the places of the forces '" : "sensors '") +
                         first + "' and '" + second + "' swapped");
    }
    suspect->frf_changes = {{static_cast<int>(r), of_forces,
                             static_cast<int>(change.one),
                             static_cast<int>(change.two)}};
  }

  static std::string NameOf(const FrfRecord& record, bool of_forces, Index i) {
    const size_t index = static_cast<size_t>(i);
    return of_forces ? record.reference_names[index]
                     : record.responses[index].name;
  }

  const IdentificationProblem& problem_;
  const IdentifiedModel& model_;
  const size_t most_;
  std::vector<Suspect> suspects_;
};

}  // namespace

std::vector<Suspect> MakeFrfSuspects(const IdentificationProblem& problem,
                                     const IdentifiedModel& model,
                                     size_t most) {
  if (problem.frfs.empty()) return {};
  return FrfCatalogue(problem, model, most).Make();
}

void ChangeFrfs(const std::vector<Suspect::FrfChange>& changes,
                IdentificationProblem* problem) {
  for (const Suspect::FrfChange& change : changes) {
    FrfRecord& record = problem->frfs[static_cast<size_t>(change.record)];
    const std::vector<Index> one =
        PairsOf(record, change.of_forces, change.one);
    const std::vector<Index> two =
        PairsOf(record, change.of_forces, change.two);
    for (size_t i = 0; i < one.size(); ++i) {
      if (change.one == change.two) {
        record.values.col(one[i]) *= -1.0;
        continue;
      }
      record.values.col(one[i]).swap(record.values.col(two[i]));
      if (record.variances.size() > 0) {
        record.variances.col(one[i]).swap(record.variances.col(two[i]));
      }
      if (record.sigma.size() > 0) {
        std::swap(record.sigma[one[i]], record.sigma[two[i]]);
      }
    }
  }
}

}  // namespace pinode
