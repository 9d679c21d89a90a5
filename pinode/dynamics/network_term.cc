#include "pinode/dynamics/network_term.h"

#include <ceres/jet.h>

#include <array>
#include <utility>

#include "pinode/network/network_functor.h"

namespace pinode {
namespace {

struct LinearizedNetwork : TermLinearization {
  explicit LinearizedNetwork(const Network& network)
      : tangent(network), workspace(network) {}

  NetworkTangent tangent;
  // Scratch.
  NetworkWorkspace workspace;
  Vector features, results, mapped;
};

struct NetworkScratch : TermTangentScratch {
  NetworkScratch(const Network& network, int rows)
      : workspace(network, rows, Term::kMostStages) {}

  std::array<Matrix, Term::kMostStages> lefts;  // rows x outputs
  NetworkWorkspace workspace;
  // rows x weights; empty unless some weights are fixed and some free.
  Matrix all_columns;
};

class NetworkDynamics final : public TermOf<NetworkTerm> {
 public:
  explicit NetworkDynamics(NetworkTerm term)
      : TermOf(std::move(term)),
        columns_(TangentColumns(description_.weights)),
        num_free_(NumFree(description_.weights)) {
    description_.weights.named = false;
  }

  TermKind kind() const override { return TermKind::kNetwork; }

  std::unique_ptr<Term> Clone() const override {
    return std::make_unique<NetworkDynamics>(*this);
  }

  bool IsValid(const StructuralModel& model, int num_inputs,
               std::string* error) const override {
    const NetworkTerm& term = description_;
    if (term.network == nullptr) {
      *error = "'" + term.name + "' has no network";
      return false;
    }
    if (!FeaturesExist(term.name, term.features, model.num_dofs(), num_inputs,
                       error)) {
      return false;
    }
    const NetworkArchitecture& architecture = network().architecture();
    if (static_cast<int>(term.features.size()) != architecture.num_inputs ||
        term.weights.size() != architecture.NumWeights() ||
        term.outputs.rows() != model.num_dofs() ||
        term.outputs.cols() != architecture.num_outputs) {
      *error = "'" + term.name +
               "': numbers of inputs, weights or outputs do not fit its "
               "architecture";
      return false;
    }
    if (!term.outputs.allFinite()) {
      *error = "'" + term.name + "': its outputs are not finite";
      return false;
    }
    return term.weights.IsValid(error);
  }

  const ParameterBlock& parameters() const override {
    return description_.weights;
  }
  void SetParameters(const Vector& values) override {
    description_.weights.SetValues(values);
  }

  std::unique_ptr<TermPrepared> Prepare(
      const LinearSystem& linear, const double* /*parameters*/) const override {
    auto prepared = std::make_unique<TermPrepared>();
    prepared->output_map = AccelerationMap(
        description_.acts_as, description_.outputs, linear.mass_inverse);
    return prepared;
  }

  std::unique_ptr<TermLinearization> MakeLinearization(
      const TermPlace& place) const override {
    auto linearization = std::make_unique<LinearizedNetwork>(network());
    linearization->features = Vector::Zero(network().num_inputs());
    linearization->results = Vector::Zero(network().num_outputs());
    linearization->mapped = Vector::Zero(place.num_dofs);
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
    AddFeatureColumns(
        prepared.output_map, description_.features,
        [&slopes](int output, int feature) { return slopes(output, feature); },
        &own->mapped, jacobian);
  }

  std::unique_ptr<TermTangentScratch> MakeTangentScratch(
      const TermPlace& /*place*/, int rows) const override {
    auto scratch = std::make_unique<NetworkScratch>(network(), rows);
    scratch->lefts.fill(Matrix::Zero(rows, network().num_outputs()));
    if (num_free_ > 0 && num_free_ < network().num_weights()) {
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
    if (num_free_ == 0) return;
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
    for (Eigen::Index w = 0; some_fixed && w < all.cols(); ++w) {
      const int column = columns_[static_cast<size_t>(w)];
      if (column < 0) continue;
      Eigen::Map<Vector>(result + all.rows() * column, all.rows()) +=
          all.col(w);
    }
  }

 private:
  const Network& network() const { return *description_.network; }

  template <typename T>
  void Gather(const TermPoint<T>& at, T* features) const {
    GatherFeatures(description_.features, at.place.num_dofs, at.time, at.input,
                   at.state, features);
  }

  template <typename T>
  void AddResultsOf(const TermPrepared& prepared, const T* results,
                    TermRate<T>* rate) const {
    AddResults(prepared.output_map, description_.acts_as, results,
               rate->acceleration, rate->force_acceleration);
  }

  std::vector<int> columns_;
  int num_free_;
};

}  // namespace

std::unique_ptr<Term> MakeTerm(NetworkTerm network) {
  return std::make_unique<NetworkDynamics>(std::move(network));
}

}  // namespace pinode
