#include "pinode/integrate/local_laws.h"

#include <algorithm>
#include <map>

namespace pinode {

LocalLaws::LocalLaws(const StructuralDynamics& dynamics) : dynamics_(dynamics) {
  const int n = dynamics.num_dofs();
  const int first_block = dynamics.groups().empty() ? 0 : 1;
  std::vector<char> looks(static_cast<size_t>(2 * n), 0);
  size_t most_features = 0;
  size_t most_results = 0;
  size_t most_slopes = 0;
  std::map<int, int> column_of_parameter;
  const std::vector<int>& columns = dynamics.tangent_columns();
  for (size_t j = 0; j < columns.size(); ++j) {
    column_of_parameter[columns[j]] = static_cast<int>(j);
  }
  std::map<int, double> factor_of_parameter;
  for (const ParameterTie& tie : dynamics.ties()) {
    const auto source = column_of_parameter.find(tie.source);
    if (source == column_of_parameter.end()) continue;
    column_of_parameter[tie.parameter] = source->second;
    factor_of_parameter[tie.parameter] = tie.factor;
  }
  int first_column = dynamics.num_tangent_columns();
  for (size_t l = 0; l < dynamics.laws().size(); ++l) {
    const LawTerm& term = dynamics.laws()[l];
    Place place;
    place.first_parameter =
        dynamics.block_offset(first_block + static_cast<int>(l));
    place.first_internal = num_internal_;
    place.first_output = num_outputs_;
    for (int p = 0; p < term.law->num_parameters(); ++p) {
      const auto found = column_of_parameter.find(place.first_parameter + p);
      const bool is_free = found != column_of_parameter.end();
      place.parameter_columns.push_back(is_free ? found->second : -1);
      const auto tied = factor_of_parameter.find(place.first_parameter + p);
      place.parameter_factors.push_back(
          tied == factor_of_parameter.end() ? 1.0 : tied->second);
      if (is_free) first_column = std::min(first_column, found->second);
    }
    num_internal_ += term.law->num_internal();
    num_outputs_ += term.law->num_outputs();
    for (const Feature& feature : term.features) {
      feature.ForEachState(n, [&looks](int index, double /*sign*/) {
        looks[static_cast<size_t>(index)] = 1;
      });
    }
    const auto results = static_cast<size_t>(term.law->num_results());
    most_features = std::max(most_features, term.features.size());
    most_results = std::max(most_results, results);
    most_slopes = std::max(
        most_slopes, results * static_cast<size_t>(term.law->num_arguments()));
    places_.push_back(std::move(place));
  }
  num_parameters_ = dynamics.num_tangent_columns() - first_column;
  column_of_state_.assign(looks.size(), -1);
  for (size_t i = 0; i < looks.size(); ++i) {
    if (looks[i] == 0) continue;
    column_of_state_[i] = static_cast<int>(states_.size());
    states_.push_back(static_cast<int>(i));
  }
  // From tangent columns to columns of the slopes.
  const int shift =
      static_cast<int>(states_.size()) + num_internal_ - first_column;
  for (Place& place : places_) {
    for (int& column : place.parameter_columns) {
      if (column >= 0) column += shift;
    }
  }
  forces_ = Matrix::Zero(n, num_outputs_);
  for (size_t l = 0; l < places_.size(); ++l) {
    const LawTerm& term = dynamics.laws()[l];
    if (term.acts_as != ActsAs::kForce) continue;
    forces_.middleCols(places_[l].first_output, term.law->num_outputs()) =
        -term.outputs;
  }
  features_.resize(most_features);
  own_.resize(most_results);
  jacobian_.resize(most_slopes);
}

Matrix LocalLaws::OutputMap(
    const StructuralDynamics::Prepared& prepared) const {
  const int n = dynamics_.num_dofs();
  const size_t first_block = dynamics_.groups().empty() ? 0 : 1;
  Matrix map = Matrix::Zero(2 * n, num_outputs_);
  for (size_t l = 0; l < places_.size(); ++l) {
    const Matrix& own = prepared.terms[first_block + l]->output_map;
    map.block(n, places_[l].first_output, n, own.cols()) = own;
  }
  return map;
}

void LocalLaws::Scatter(const LawTerm& term, const Place& place,
                        double* results) const {
  const int outputs = term.law->num_outputs();
  std::copy_n(own_.begin(), outputs, results + place.first_output);
  std::copy_n(own_.begin() + outputs, term.law->num_internal(),
              results + num_outputs_ + place.first_internal);
}

void LocalLaws::Evaluate(const StructuralDynamics::Prepared& prepared,
                         double time, const double* input, const double* state,
                         double* results) {
  const int n = dynamics_.num_dofs();
  for (size_t l = 0; l < places_.size(); ++l) {
    const LawTerm& term = dynamics_.laws()[l];
    const Place& place = places_[l];
    GatherFeatures(term.features, n, time, input, state, features_.data());
    term.law->Evaluate(features_.data(), state + 2 * n + place.first_internal,
                       prepared.theta.data() + place.first_parameter,
                       own_.data());
    Scatter(term, place, results);
  }
}

void LocalLaws::Linearize(const StructuralDynamics::Prepared& prepared,
                          double time, const double* input, const double* state,
                          double* results, Matrix* slopes) {
  const int n = dynamics_.num_dofs();
  const int looked_at = static_cast<int>(states_.size());
  slopes->setZero(num_outputs_ + num_internal_,
                  looked_at + num_internal_ + num_parameters_);
  for (size_t l = 0; l < places_.size(); ++l) {
    const LawTerm& term = dynamics_.laws()[l];
    const Law& law = *term.law;
    const Place& place = places_[l];
    GatherFeatures(term.features, n, time, input, state, features_.data());
    law.Linearize(features_.data(), state + 2 * n + place.first_internal,
                  prepared.theta.data() + place.first_parameter, own_.data(),
                  jacobian_.data());
    Scatter(term, place, results);
    for (int r = 0; r < law.num_results(); ++r) {
      const int row =
          r < law.num_outputs()
              ? place.first_output + r
              : num_outputs_ + place.first_internal + r - law.num_outputs();
      const double* slope =
          jacobian_.data() + static_cast<ptrdiff_t>(r) * law.num_arguments();
      for (const Feature& feature : term.features) {
        feature.ForEachState(n, [&](int index, double sign) {
          (*slopes)(row, column_of_state_[static_cast<size_t>(index)]) +=
              sign * *slope;
        });
        ++slope;
      }
      for (int i = 0; i < law.num_internal(); ++i) {
        (*slopes)(row, looked_at + place.first_internal + i) += *slope++;
      }
      for (size_t p = 0; p < place.parameter_columns.size(); ++p) {
        const int column = place.parameter_columns[p];
        if (column >= 0) {
          (*slopes)(row, column) += place.parameter_factors[p] * *slope;
        }
        ++slope;
      }
    }
  }
}

}  // namespace pinode
