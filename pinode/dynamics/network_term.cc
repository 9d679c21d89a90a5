#include "pinode/dynamics/network_term.h"

#include <ceres/jet.h>

#include <algorithm>
#include <array>
#include <utility>

#include "pinode/base/small_matrix.h"
#include "pinode/dynamics/described_term.h"
#include "pinode/network/network_functor.h"

namespace pinode {
namespace {

struct LinearizedNetwork : TermLinearization {
  explicit LinearizedNetwork(const Network& network)
      : tangent(network), workspace(network) {}

  NetworkTangent tangent;
  // Scratch.
  NetworkWorkspace workspace;
  Vector features, results;
  Matrix mapped;  // accelerations by features
};

struct NetworkScratch : TermTangentScratch {
  NetworkScratch(const Network& network, int rows)
      : workspace(network, rows, Term::kMostStages) {}

  std::array<Matrix, Term::kMostStages> lefts;  // rows x outputs
  NetworkWorkspace workspace;
  // rows x weights; empty unless some weights are fixed and some free.
  Matrix all_columns;
};

class NetworkDynamics final
    : public FeatureTerm<NetworkDynamics, NetworkTerm, &NetworkTerm::weights> {
 public:
  explicit NetworkDynamics(NetworkTerm term) : FeatureTerm(std::move(term)) {
    description_.weights.named = false;
  }

  TermKind kind() const override { return TermKind::kNetwork; }

  bool IsValid(const StructuralModel& model, int num_inputs,
               std::string* error) const override {
    const NetworkTerm& term = description_;
    if (term.network == nullptr) {
      *error = "'" + term.name + "' has no network";
      return false;
    }
    const NetworkArchitecture& architecture = network().architecture();
    return Fits(model, num_inputs, architecture.num_inputs,
                architecture.num_outputs, architecture.NumWeights(),
                "its architecture", error);
  }

  std::unique_ptr<TermLinearization> MakeLinearization(
      const TermPlace& place) const override {
    auto linearization = std::make_unique<LinearizedNetwork>(network());
    linearization->features = Vector::Zero(network().num_inputs());
    linearization->results = Vector::Zero(network().num_outputs());
    linearization->mapped =
        Matrix::Zero(place.num_dofs, network().num_inputs());
    return linearization;
  }

  void AddRate(const TermPrepared& prepared, const TermPoint<double>& at,
               TermRate<double>* rate,
               TermLinearization* scratch) const override {
    auto* own = static_cast<LinearizedNetwork*>(scratch);
    Gather(at, own->features.data());
    network().Evaluate(own->features.data(), at.parameters, own->results.data(),
                       &own->workspace);
    AddResultsOf(prepared, own->results.data(), rate);
  }

  void AddRate(const TermPrepared& prepared, const TermPoint<WideJet>& at,
               TermRate<WideJet>* rate) const override {
    std::vector<WideJet> features(static_cast<size_t>(network().num_inputs()));
    std::vector<WideJet> results(static_cast<size_t>(network().num_outputs()));
    Gather(at, features.data());
    EvaluateNetwork(network().architecture(), features.data(), at.parameters,
                    results.data());
    AddResultsOf(prepared, results.data(), rate);
  }

  void Linearize(const TermPrepared& prepared, const TermPoint<double>& at,
                 TermRate<double>* rate, Matrix* jacobian,
                 TermLinearization* kept) const override {
    auto* own = static_cast<LinearizedNetwork*>(kept);
    Gather(at, own->features.data());
    network().Linearize(own->features.data(), at.parameters, &own->tangent);
    AddResultsOf(prepared, own->tangent.value().data(), rate);
    const Matrix& slopes = own->tangent.input_jacobian();
    const int n = at.place.num_dofs;
    MultiplySmall(n, network().num_outputs(), network().num_inputs(),
                  prepared.output_map.data(), slopes.data(),
                  own->mapped.data());
    for (size_t f = 0; f < description_.features.size(); ++f) {
      AddFeatureColumn(description_.features[f],
                       own->mapped.col(static_cast<int>(f)).data(), n,
                       jacobian);
    }
  }

  std::unique_ptr<TermTangentScratch> MakeTangentScratch(
      const TermPlace& /*place*/, int rows) const override {
    auto scratch = std::make_unique<NetworkScratch>(network(), rows);
    scratch->lefts.fill(Matrix::Zero(rows, network().num_outputs()));
    if (num_free() > 0 && num_free() < network().num_weights()) {
      scratch->all_columns = Matrix::Zero(rows, network().num_weights());
    }
    return scratch;
  }

  void AddParameterTangents(const TermPlace& place,
                            const TermPrepared& prepared,
                            const TermLinearization* const* stages,
                            const Matrix* const* lefts, int num_stages,
                            TermTangentScratch* scratch,
                            double* result) const override {
    if (num_free() == 0) return;
    auto* own = static_cast<NetworkScratch*>(scratch);
    const int n = place.num_dofs;
    const NetworkTangent* tangents[kMostStages];
    const Matrix* own_lefts[kMostStages];
    for (int s = 0; s < num_stages; ++s) {
      Matrix& left = own->lefts[static_cast<size_t>(s)];
      left.noalias() =
          lefts[s]->middleCols(n, n).lazyProduct(prepared.output_map);
      own_lefts[s] = &left;
      tangents[s] = &static_cast<const LinearizedNetwork&>(*stages[s]).tangent;
    }
    Matrix& all = own->all_columns;
    const bool some_fixed = all.size() > 0;
    if (some_fixed) all.setZero();
    network().AddWeightTangents(tangents, own_lefts, num_stages,
                                &own->workspace,
                                some_fixed ? all.data() : result);
    for (int w = 0; some_fixed && w < all.cols(); ++w) {
      AddToColumn(w, all.col(w), 1.0, result);
    }
  }

 private:
  const Network& network() const { return *description_.network; }
};

}  // namespace

bool IsForceOfTime(const NetworkTerm& term) {
  return term.acts_as == ActsAs::kForce &&
         std::all_of(term.features.begin(), term.features.end(),
                     [](const Feature& feature) {
                       return feature.kind == Feature::Kind::kTime;
                     });
}

std::unique_ptr<Term> MakeTerm(NetworkTerm network) {
  return std::make_unique<NetworkDynamics>(std::move(network));
}

}  // namespace pinode
