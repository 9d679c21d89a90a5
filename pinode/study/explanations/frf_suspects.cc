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

// Correlations of measured pairs (rows) with those of the model (columns), over
// the lines that are present. Pairs are weighted as in the fit.
Matrix AgreementOf(const FrfRecord& record, const ComplexMatrix& modelled) {
  ComplexMatrix measured = record.values;
  ComplexMatrix expected = modelled;
  for (Index p = 0; p < measured.cols(); ++p) {
    for (Index k = 0; k < measured.rows(); ++k) {
      const bool is_present = std::isfinite(std::abs(measured(k, p)));
      if (!is_present) measured(k, p) = 0.0;
    }
    const double own = measured.col(p).norm();
    const double other = expected.col(p).norm();
    if (own > 0.0) measured.col(p) /= own;
    if (other > 0.0) expected.col(p) /= other;
  }
  return (measured.adjoint() * expected).real();
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
    AddGains();
    for (size_t r = 0; r < problem_.frfs.size(); ++r) AddPlaces(r);
    return std::move(suspects_);
  }

 private:
  // Gains that the problem has as unknowns are no suspects.
  void AddGains() {
    std::map<std::string, std::vector<std::pair<int, int>>> sensors;
    std::vector<std::pair<int, int>> all;
    for (size_t r = 0; r < problem_.frfs.size(); ++r) {
      const FrfRecord& record = problem_.frfs[r];
      for (size_t o = 0; o < record.responses.size(); ++o) {
        if (!record.gains.empty() && record.gains[o] >= 0) return;
        all.emplace_back(static_cast<int>(r), static_cast<int>(o));
        sensors[record.responses[o].name].push_back(all.back());
      }
    }
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

  void AddPlaces(size_t r) {
    const FrfRecord& record = problem_.frfs[r];
    std::vector<Matrix> agreements;
    const Vector initial = ParameterLayout(problem_).InitialValues();
    for (const Vector& at : {model_.parameters, initial}) {
      const ComplexMatrix modelled = ModelledFrfs(problem_, record, at);
      if (modelled.rows() == 0 || !modelled.allFinite()) continue;
      agreements.push_back(AgreementOf(record, modelled));
    }
    for (const bool of_forces : {false, true}) {
      std::vector<std::pair<double, Suspect>> turns, exchanges;
      const Index count =
          of_forces ? record.num_references() : record.num_responses();
      for (Index c = 0; c < count; ++c) {
        AddTurn(r, agreements, of_forces, c, &turns);
        for (Index d = 0; d < c; ++d) {
          AddExchange(r, agreements, of_forces, d, c, &exchanges);
        }
      }
      KeepLikeliest(&turns);
      KeepLikeliest(&exchanges);
    }
  }

  static std::string NameOf(const FrfRecord& record, bool of_forces, Index i) {
    const size_t index = static_cast<size_t>(i);
    return of_forces ? record.reference_names[index]
                     : record.responses[index].name;
  }

  void AddTurn(size_t r, const std::vector<Matrix>& agreements, bool of_forces,
               Index c, std::vector<std::pair<double, Suspect>>* turns) const {
    const FrfRecord& record = problem_.frfs[r];
    double gain = 0.0;
    for (const Matrix& agreement : agreements) {
      double sum = 0.0;
      for (const Index p : PairsOf(record, of_forces, c)) {
        sum -= 2.0 * agreement(p, p);
      }
      gain = std::max(gain, sum);
    }
    if (!(gain > 0.0)) return;
    const std::string name = NameOf(record, of_forces, c);
    Suspect suspect;
    suspect.kind = of_forces ? Kind::kExcitationScale : Kind::kSensorGain;
    suspect.place = name;
    suspect.what = of_forces
                       ? "the force at '" + name + "' in the other direction"
                       : "sensor '" + name + "' mounted upside down";
    suspect.frf_changes = {{static_cast<int>(r), of_forces, static_cast<int>(c),
                            static_cast<int>(c)}};
    turns->emplace_back(gain, std::move(suspect));
  }

  void AddExchange(size_t r, const std::vector<Matrix>& agreements,
                   bool of_forces, Index c, Index d,
                   std::vector<std::pair<double, Suspect>>* exchanges) const {
    const FrfRecord& record = problem_.frfs[r];
    if (!of_forces && record.responses[static_cast<size_t>(c)].quantity !=
                          record.responses[static_cast<size_t>(d)].quantity) {
      return;
    }
    const std::vector<Index> one = PairsOf(record, of_forces, c);
    const std::vector<Index> two = PairsOf(record, of_forces, d);
    double gain = 0.0;
    for (const Matrix& agreement : agreements) {
      double sum = 0.0;
      for (size_t i = 0; i < one.size(); ++i) {
        sum += agreement(one[i], two[i]) + agreement(two[i], one[i]) -
               agreement(one[i], one[i]) - agreement(two[i], two[i]);
      }
      gain = std::max(gain, sum);
    }
    if (!(gain > 0.0)) return;
    const std::string first = NameOf(record, of_forces, c);
    const std::string second = NameOf(record, of_forces, d);
    Suspect suspect;
    suspect.kind = of_forces ? Kind::kForcePlace : Kind::kExchange;
    suspect.place = first + "," + second;
    suspect.what = (of_forces ? "the places of the forces '" : "sensors '") +
                   first + "' and '" + second + "' swapped";
    suspect.frf_changes = {{static_cast<int>(r), of_forces, static_cast<int>(c),
                            static_cast<int>(d)}};
    exchanges->emplace_back(gain, std::move(suspect));
  }

  void KeepLikeliest(std::vector<std::pair<double, Suspect>>* ranked) {
    std::stable_sort(
        ranked->begin(), ranked->end(),
        [](const auto& a, const auto& b) { return a.first > b.first; });
    if (ranked->size() > most_) ranked->resize(most_);
    for (auto& [unused, suspect] : *ranked) {
      suspects_.push_back(std::move(suspect));
    }
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
