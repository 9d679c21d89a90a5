#include "pinode/network/network.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/small_matrix.h"
#include "pinode/network/activation.h"

namespace pinode {
namespace {

using ConstMatrixMap = Eigen::Map<const Matrix>;

ConstMatrixMap MapPart(const WeightLayout::Part& part, const double* weights) {
  return {weights + part.offset, part.rows, part.cols};
}

int WidestHiddenLayer(const NetworkArchitecture& architecture) {
  int widest = 0;
  for (const int width : architecture.hidden_widths) {
    widest = std::max(widest, width);
  }
  return widest;
}

// Sets the adjoint of a_l, D_{l+1} W_{l+1}. Behind the last layer it is the
// identity times `sign`.
void PropagateAdjoint(const WeightLayout::Part& next, const double* weights,
                      double sign, int l, NetworkSweep* sweep) {
  Matrix& adjoint = sweep->layers[l].adjoint;
  const Matrix& next_adjoint = sweep->layers[l + 1].adjoint;
  if (next_adjoint.size() == 0) {
    adjoint = sign * MapPart(next, weights);
  } else {
    MultiplySmall(static_cast<int>(adjoint.rows()), next.rows, next.cols,
                  next_adjoint.data(), weights + next.offset, adjoint.data());
  }
}

}  // namespace

NetworkSweep::NetworkSweep(const NetworkArchitecture& architecture,
                           double last_entry) {
  const WeightLayout layout = architecture.Layout();
  const int num_layers = layout.num_layers();
  layers.resize(num_layers);
  for (int l = 0; l < num_layers; ++l) {
    const WeightLayout::Part& part = layout.weights[l];
    layers[l].input.setConstant(part.cols + layout.biases[l].cols, last_entry);
    if (l + 1 == num_layers) break;
    layers[l].preactivation.setZero(part.rows);
    layers[l].slope.setZero(part.rows);
    layers[l].curvature.setZero(part.rows);
    layers[l].adjoint.setZero(architecture.num_outputs, part.rows);
  }
}

NetworkTangent::NetworkTangent(const Network& network)
    : value_(Vector::Zero(network.num_outputs())),
      input_jacobian_(
          Matrix::Zero(network.num_outputs(), network.num_inputs())),
      first_adjoint_(Matrix::Zero(network.num_outputs(),
                                  network.layout().weights.front().rows)),
      point_(network.architecture(), 1.0),
      rest_(network.architecture(), 1.0),
      rate_(network.architecture(), 0.0) {}

NetworkWorkspace::NetworkWorkspace(const Network& network, int max_rows,
                                   int max_stages)
    : max_rows_(max_rows),
      max_stages_(max_stages),
      point_(network.architecture(), 1.0),
      rest_(network.architecture(), 1.0),
      rate_(network.architecture(), 0.0),
      slice_(max_rows * WidestHiddenLayer(network.architecture())) {
  CHECK_GE(max_rows, 0);
  CHECK_GE(max_stages, 1);
  const int max_factors = max_stages * (network.architecture().gauge ? 3 : 1);
  products_.setZero(max_factors * slice_);
  scaled_lefts_.setZero(std::ptrdiff_t{max_stages} * max_rows *
                        network.architecture().output_scale.size());
  stage_lefts_.reserve(max_stages);
  lefts_.reserve(max_factors);
  rights_.reserve(max_factors);
}

Network::Network(NetworkArchitecture architecture)
    : architecture_(std::move(architecture)) {
  std::string error;
  CHECK(architecture_.IsValid(&error)) << error;
  layout_ = architecture_.Layout();
  inverse_scale_ = Vector::Ones(num_inputs());
  if (architecture_.input_scale.size() != 0) {
    inverse_scale_ = architecture_.input_scale.cwiseInverse();
  }
}

void Network::Evaluate(const double* q, const double* weights, double* y,
                       NetworkWorkspace* workspace) const {
  SweepForward(q, weights, /*tangent=*/false, &workspace->point_,
               &workspace->rest_, &workspace->rate_);
  EvaluateOutput(workspace->point_, weights, y);
}

void Network::Linearize(const double* q, const double* weights,
                        NetworkTangent* tangent) const {
  SweepForward(q, weights, /*tangent=*/true, &tangent->point_, &tangent->rest_,
               &tangent->rate_);
  EvaluateOutput(tangent->point_, weights, tangent->value_.data());
  SweepBackward(weights, tangent);
}

void Network::SweepForward(const double* q, const double* weights, bool tangent,
                           NetworkSweep* point, NetworkSweep* rest,
                           NetworkSweep* rate) const {
  const Eigen::Map<const Vector> features(q, num_inputs());
  point->layers[0].input.head(num_inputs()) =
      features.cwiseProduct(inverse_scale_);
  SweepLayers(weights, tangent, /*curvature=*/false, point);
  if (!architecture_.gauge) return;

  rest->layers[0].input.head(num_inputs()).setZero();
  SweepLayers(weights, /*slope=*/true, /*curvature=*/tangent, rest);
  rate->layers[0].input.head(num_inputs()) =
      point->layers[0].input.head(num_inputs());
  const int last = layout_.num_layers() - 1;
  for (int l = 0; l < last; ++l) {
    const WeightLayout::Part& part = layout_.weights[l];
    NetworkSweep::Layer& layer = rate->layers[l];
    MultiplySmall(part.rows, part.cols, 1, weights + part.offset,
                  layer.input.data(), layer.preactivation.data());
    rate->layers[l + 1].input.head(part.rows) =
        layer.preactivation.cwiseProduct(rest->layers[l].slope);
  }
  // W_L acts on all three in the same way.
  point->layers[last].input -=
      rest->layers[last].input + rate->layers[last].input;
}

void Network::SweepLayers(const double* weights, bool slope, bool curvature,
                          NetworkSweep* sweep) const {
  for (int l = 0; l + 1 < layout_.num_layers(); ++l) {
    const WeightLayout::Part& part = layout_.weights[l];
    NetworkSweep::Layer& layer = sweep->layers[l];
    MultiplySmall(part.rows, static_cast<int>(layer.input.size()), 1,
                  weights + part.offset, layer.input.data(),
                  layer.preactivation.data());
    ApplyActivation(
        architecture_.activation, part.rows, layer.preactivation.data(),
        sweep->layers[l + 1].input.data(), slope ? layer.slope.data() : nullptr,
        curvature ? layer.curvature.data() : nullptr);
  }
}

void Network::EvaluateOutput(const NetworkSweep& point, const double* weights,
                             double* y) const {
  const WeightLayout::Part& last = layout_.weights.back();
  const Vector& input = point.layers.back().input;
  MultiplySmall(last.rows, static_cast<int>(input.size()), 1,
                weights + last.offset, input.data(), y);
  Eigen::Map<Vector> output(y, num_outputs());
  if (layout_.skip.size() > 0) {
    output.noalias() +=
        MapPart(layout_.skip, weights)
            .lazyProduct(point.layers.front().input.head(num_inputs()));
  }
  if (architecture_.output_scale.size() > 0) {
    output.array() *= architecture_.output_scale.array();
  }
}

void Network::SweepBackward(const double* weights,
                            NetworkTangent* tangent) const {
  const int last = layout_.num_layers() - 1;
  const WeightLayout::Part& output = layout_.weights[last];
  if (last == 0) {
    tangent->input_jacobian_ = MapPart(output, weights);
    ScaleJacobian(&tangent->input_jacobian_);
    return;
  }

  NetworkSweep& point = tangent->point_;
  NetworkSweep& rest = tangent->rest_;
  NetworkSweep& rate = tangent->rate_;
  for (int l = last - 1; l >= 0; --l) {
    if (l + 1 < last) {
      PropagateAdjoint(layout_.weights[l + 1], weights, 1.0, l, &point);
    }
    Matrix& adjoint = point.layers[l].adjoint;
    ScaleColumnsSmall(num_outputs(), static_cast<int>(adjoint.cols()),
                      l + 1 < last ? adjoint.data() : weights + output.offset,
                      point.layers[l].slope.data(), adjoint.data());
    if (!architecture_.gauge) continue;
    // With z0 the preactivation at rest and W_l t its rate, the sweeps at rest
    // and along the rate compute act(z0) and act'(z0) (W_l t): the latter
    // depends on z0 too.
    PropagateAdjoint(layout_.weights[l + 1], weights, -1.0, l, &rate);
    PropagateAdjoint(layout_.weights[l + 1], weights, -1.0, l, &rest);
    NetworkSweep::Layer& at_rest = rest.layers[l];
    NetworkSweep::Layer& at_rate = rate.layers[l];
    at_rest.curvature.array() *= at_rate.preactivation.array();
    at_rest.adjoint *= at_rest.slope.asDiagonal();
    at_rest.adjoint.noalias() +=
        at_rate.adjoint * at_rest.curvature.asDiagonal();
    at_rate.adjoint *= at_rest.slope.asDiagonal();
  }

  const WeightLayout::Part& first = layout_.weights.front();
  const double* first_adjoint = point.layers[0].adjoint.data();
  if (architecture_.gauge) {
    tangent->first_adjoint_ = point.layers[0].adjoint + rate.layers[0].adjoint;
    first_adjoint = tangent->first_adjoint_.data();
  }
  MultiplySmall(num_outputs(), first.rows, first.cols, first_adjoint,
                weights + first.offset, tangent->input_jacobian_.data());
  if (layout_.skip.size() > 0) {
    tangent->input_jacobian_ += MapPart(layout_.skip, weights);
  }
  ScaleJacobian(&tangent->input_jacobian_);
}

void Network::ScaleJacobian(Matrix* jacobian) const {
  ScaleColumnsSmall(num_outputs(), num_inputs(), jacobian->data(),
                    inverse_scale_.data(), jacobian->data());
  for (int i = 0; i < architecture_.output_scale.size(); ++i) {
    jacobian->row(i) *= architecture_.output_scale[i];
  }
}

void Network::ScaleLefts(const Matrix* const* lefts, int count,
                         NetworkWorkspace* workspace) const {
  const Vector& scale = architecture_.output_scale;
  workspace->stage_lefts_.clear();
  double* scaled = workspace->scaled_lefts_.data();
  for (int s = 0; s < count; ++s) {
    if (scale.size() == 0) {
      workspace->stage_lefts_.push_back(lefts[s]->data());
      continue;
    }
    const Eigen::Index rows = lefts[s]->rows();
    Eigen::Map<Matrix>(scaled, rows, scale.size()) =
        *lefts[s] * scale.asDiagonal();
    workspace->stage_lefts_.push_back(scaled);
    scaled += rows * scale.size();
  }
}

void Network::AddWeightTangent(const NetworkTangent& tangent,
                               const Matrix& left, NetworkWorkspace* workspace,
                               double* B) const {
  const NetworkTangent* const stages[] = {&tangent};
  const Matrix* const lefts[] = {&left};
  AddWeightTangents(stages, lefts, 1, workspace, B);
}

void Network::AddWeightTangents(const NetworkTangent* const* stages,
                                const Matrix* const* lefts, int count,
                                NetworkWorkspace* workspace, double* B) const {
  if (count == 0) return;
  const int rows = static_cast<int>(lefts[0]->rows());
  CHECK_LE(count, workspace->max_stages_)
      << "Construct the workspace for as many stages.";
  CHECK_LE(rows, workspace->max_rows_)
      << "Construct the workspace for as many rows.";
  for (int s = 0; s < count; ++s) {
    CHECK_EQ(lefts[s]->rows(), rows);
    CHECK_EQ(lefts[s]->cols(), num_outputs());
  }
  ScaleLefts(lefts, count, workspace);
  const std::vector<const double*>& scaled = workspace->stage_lefts_;

  // The part of W_l and b_l in B is, read as a matrix of rows * width rows and
  // a column per input, the sum of outer products vec(left D_l) a_{l-1}'.
  std::vector<const double*>& v = workspace->lefts_;
  std::vector<const double*>& a = workspace->rights_;
  const int last = layout_.num_layers() - 1;
  for (int l = 0; l < last; ++l) {
    const WeightLayout::Part& part = layout_.weights[l];
    v.clear();
    a.clear();
    const auto add_factor = [&](const double* left,
                                const NetworkSweep::Layer& layer) {
      double* product =
          workspace->products_.data() + v.size() * workspace->slice_;
      MultiplySmall(rows, num_outputs(), part.rows, left, layer.adjoint.data(),
                    product);
      v.push_back(product);
      a.push_back(layer.input.data());
    };
    for (int s = 0; s < count; ++s) {
      add_factor(scaled[s], stages[s]->point_.layers[l]);
      if (!architecture_.gauge) continue;
      add_factor(scaled[s], stages[s]->rest_.layers[l]);
      add_factor(scaled[s], stages[s]->rate_.layers[l]);
    }
    AddOuterProducts(static_cast<int>(v.size()), rows * part.rows,
                     part.cols + layout_.biases[l].cols, v.data(), a.data(),
                     B + std::ptrdiff_t{part.offset} * rows);
  }

  // If D is the identity, `left` itself is the factor.
  v.clear();
  a.clear();
  for (int s = 0; s < count; ++s) {
    v.push_back(scaled[s]);
    a.push_back(stages[s]->point_.layers[last].input.data());
  }
  const WeightLayout::Part& output = layout_.weights[last];
  AddOuterProducts(count, rows * output.rows,
                   output.cols + layout_.biases[last].cols, v.data(), a.data(),
                   B + std::ptrdiff_t{output.offset} * rows);
  if (layout_.skip.size() == 0) return;
  a.clear();
  for (int s = 0; s < count; ++s) {
    a.push_back(stages[s]->point_.layers.front().input.data());
  }
  AddOuterProducts(count, rows * layout_.skip.rows, layout_.skip.cols, v.data(),
                   a.data(), B + std::ptrdiff_t{layout_.skip.offset} * rows);
}

Matrix Network::WeightJacobian(const NetworkTangent& tangent) const {
  NetworkWorkspace workspace(*this, num_outputs(), 1);
  Matrix jacobian = Matrix::Zero(num_outputs(), num_weights());
  AddWeightTangent(tangent, Matrix::Identity(num_outputs(), num_outputs()),
                   &workspace, jacobian.data());
  return jacobian;
}

}  // namespace pinode
