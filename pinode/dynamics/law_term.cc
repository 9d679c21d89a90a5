#include "pinode/dynamics/law_term.h"

#include <ceres/jet.h>

#include <utility>

#include "pinode/dynamics/described_term.h"

namespace pinode {
namespace {

struct LinearizedLaw : TermLinearization {
  // Derivatives of Law::Linearize, whose row-major results x arguments are the
  // transpose.
  Matrix jacobian;  // arguments x results
  // Scratch.
  Vector features, results, mapped;
  const char* branches = nullptr;
};

struct LawScratch : TermTangentScratch {
  Vector mapped;  // rows
};

class LawDynamics final
    : public FeatureTerm<LawDynamics, LawTerm, &LawTerm::parameters> {
 public:
  using FeatureTerm::FeatureTerm;

  TermKind kind() const override { return TermKind::kLaw; }
  bool IsConstant() const override { return description_.law->IsIdle(); }

  bool IsValid(const StructuralModel& model, int num_inputs,
               std::string* error) const override {
    const LawTerm& term = description_;
    if (term.law == nullptr) {
      *error = "'" + term.name + "' has no law";
      return false;
    }
    return Fits(model, num_inputs, law().num_features(), law().num_outputs(),
                law().num_parameters(), "its law", error);
  }

  std::vector<std::string> InternalNames() const override {
    std::vector<std::string> names;
    const int count = law().num_internal();
    for (int i = 0; i < count; ++i) {
      names.push_back("z[" + description_.name +
                      (count > 1 ? "," + std::to_string(i + 1) : "") + "]");
    }
    return names;
  }

  std::unique_ptr<TermLinearization> MakeLinearization(
      const TermPlace& place) const override {
    auto linearization = std::make_unique<LinearizedLaw>();
    linearization->jacobian =
        Matrix::Zero(law().num_arguments(), law().num_results());
    linearization->features = Vector::Zero(law().num_features());
    linearization->results = Vector::Zero(law().num_results());
    linearization->mapped = Vector::Zero(place.num_dofs);
    return linearization;
  }

  void AddRate(const TermPrepared& prepared, const TermPoint<double>& at,
               TermRate<double>* rate,
               TermLinearization* scratch) const override {
    auto* own = static_cast<LinearizedLaw*>(scratch);
    if (own->branches == nullptr) {
      AddRateOf(prepared, at, own->features.data(), own->results.data(), rate);
      return;
    }
    Gather(at, own->features.data());
    law().EvaluateOn(own->branches, own->features.data(), at.internal(),
                     at.parameters, own->results.data());
    AddAll(prepared, own->results.data(), rate);
  }

  void AddRate(const TermPrepared& prepared, const TermPoint<WideJet>& at,
               TermRate<WideJet>* rate) const override {
    std::vector<WideJet> features(static_cast<size_t>(law().num_features()));
    std::vector<WideJet> results(static_cast<size_t>(law().num_results()));
    AddRateOf(prepared, at, features.data(), results.data(), rate);
  }

  void Linearize(const TermPrepared& prepared, const TermPoint<double>& at,
                 TermRate<double>* rate, Matrix* jacobian,
                 TermLinearization* kept) const override {
    auto* own = static_cast<LinearizedLaw*>(kept);
    const int n = at.place.num_dofs;
    const int outputs = law().num_outputs();
    const int internal = law().num_internal();
    const int features = law().num_features();
    Gather(at, own->features.data());
    if (own->branches == nullptr) {
      law().Linearize(own->features.data(), at.internal(), at.parameters,
                      own->results.data(), own->jacobian.data());
    } else {
      law().LinearizeOn(own->branches, own->features.data(), at.internal(),
                        at.parameters, own->results.data(),
                        own->jacobian.data());
    }
    AddAll(prepared, own->results.data(), rate);

    const Matrix& map = prepared.output_map;
    const Matrix& slopes = own->jacobian;
    AddFeatureColumns(
        map, description_.features,
        [&slopes](int output, int feature) { return slopes(feature, output); },
        &own->mapped, jacobian);
    const int first = at.place.first_internal;
    for (int i = 0; i < internal; ++i) {
      for (int f = 0; f < features; ++f) {
        description_.features[static_cast<size_t>(f)].ForEachState(
            n, [&](int index, double sign) {
              (*jacobian)(first + i, index) += sign * slopes(f, outputs + i);
            });
      }
      for (int k = 0; k < internal; ++k) {
        (*jacobian)(first + k, first + i) += slopes(features + i, outputs + k);
      }
      for (int o = 0; o < outputs; ++o) {
        jacobian->col(first + i).segment(n, n) +=
            map.col(o) * slopes(features + i, o);
      }
    }
  }

  std::unique_ptr<TermTangentScratch> MakeTangentScratch(
      const TermPlace& /*place*/, int rows) const override {
    auto scratch = std::make_unique<LawScratch>();
    scratch->mapped = Vector::Zero(rows);
    return scratch;
  }

  void AddParameterTangents(const TermPlace& place,
                            const TermPrepared& prepared,
                            const TermLinearization* const* stages,
                            const Matrix* const* lefts, int num_stages,
                            TermTangentScratch* scratch,
                            double* result) const override {
    if (num_free() == 0) return;
    const int n = place.num_dofs;
    const int outputs = law().num_outputs();
    const int first_parameter = law().num_features() + law().num_internal();
    Vector& mapped = static_cast<LawScratch*>(scratch)->mapped;
    for (int s = 0; s < num_stages; ++s) {
      const Matrix& slopes =
          static_cast<const LinearizedLaw&>(*stages[s]).jacobian;
      for (int r = 0; r < law().num_results(); ++r) {
        if (r < outputs) {
          mapped.noalias() =
              lefts[s]->middleCols(n, n) * prepared.output_map.col(r);
        } else {
          mapped = lefts[s]->col(place.first_internal + r - outputs);
        }
        for (int p = 0; p < law().num_parameters(); ++p) {
          AddToColumn(p, mapped, slopes(first_parameter + p, r), result);
        }
      }
    }
  }

  int num_switches() const override { return law().num_switches(); }

  // Switches are rare, so that these two may allocate.
  void Switches(const TermPoint<double>& at, double* values) const override {
    Vector features(law().num_features());
    Gather(at, features.data());
    law().Switches(features.data(), values);
  }

  void AddSwitchGradient(int j, const TermPoint<double>& at,
                         double* gradient) const override {
    Vector features(law().num_features());
    Vector slopes(law().num_features());
    Gather(at, features.data());
    law().SwitchGradient(j, features.data(), slopes.data());
    for (Eigen::Index f = 0; f < slopes.size(); ++f) {
      description_.features[static_cast<size_t>(f)].ForEachState(
          at.place.num_dofs,
          [&](int index, double sign) { gradient[index] += sign * slopes[f]; });
    }
  }

  void SetBranches(const char* branches,
                   TermLinearization* kept) const override {
    static_cast<LinearizedLaw*>(kept)->branches = branches;
  }

 private:
  const Law& law() const { return *description_.law; }

  template <typename T>
  void AddAll(const TermPrepared& prepared, const T* results,
              TermRate<T>* rate) const {
    AddResultsOf(prepared, results, rate);
    for (int i = 0; i < law().num_internal(); ++i) {
      rate->internal[i] = results[law().num_outputs() + i];
    }
  }

  template <typename T>
  void AddRateOf(const TermPrepared& prepared, const TermPoint<T>& at,
                 T* features, T* results, TermRate<T>* rate) const {
    Gather(at, features);
    law().Evaluate(features, at.internal(), at.parameters, results);
    AddAll(prepared, results, rate);
  }
};

}  // namespace

std::unique_ptr<Term> MakeTerm(LawTerm law) {
  return std::make_unique<LawDynamics>(std::move(law));
}

}  // namespace pinode
