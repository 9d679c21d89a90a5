#include "pinode/estimate/certainty/profiler.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "pinode/base/constants.h"
#include "pinode/estimate/certainty/covariance.h"
#include "pinode/estimate/certainty/fitted_cost.h"
#include "pinode/estimate/certainty/profile_combinations.h"

namespace pinode {
namespace {

// Quantiles of chi^2 with one degree of freedom.
constexpr double kChi95 = 3.841458820694124;
constexpr double kChi99 = 6.634896601021213;
// Largest distance of points from a threshold, as a share of its square root.
constexpr double kNear = 0.1;
// Tolerance of each point's minimum, as a share of the likelihood ratio.
constexpr double kRatioTolerance = 1e-3;
// Ratios below this are zero at this distance from the estimate.
constexpr double kFlat = 1e-2;
constexpr double kFlatTenth = 0.1;
constexpr int kMostPoints = 20;  // to one side
constexpr int kMostJumps = 6;
constexpr double kMostPower = 5.0;  // of a product along the way
constexpr int kMostIterations = 50;
// Iterations of the search for the origin of all profiles. A fit with networks
// ends when the remaining error is invisible, far from a minimum.
constexpr int kMostFirstIterations = 200;
// Multiple of the last minimum's cost above which starts are searched twice.
constexpr double kStrayCost = 2.0;
// Multiple of the last threshold's root above which no minimum is searched,
// while steps can be shortened.
constexpr double kHopeless = 10.0;
// Longest walk to one side, in multiples of the parameter's value or of its
// size.
constexpr double kFar = 100.0;

// Returns d free / d (free[held]) along the minima, by the Hessian at one of
// them.
Vector PathDirection(const CondensedSystem& system, int held) {
  // The held parameter has a row of its own, decoupled from the others.
  Matrix hessian = system.hessian;
  Vector right = -hessian.col(held);
  right[held] = 0.0;
  hessian.row(held).setZero();
  hessian.col(held).setZero();
  hessian(held, held) = 1.0;
  Vector direction = SolveInformation(hessian, right);
  if (direction.size() == 0) direction = Vector::Zero(right.size());
  direction[held] = 1.0;
  return direction;
}

MultipleShooting::Options OneThread(const IdentificationOptions& options) {
  MultipleShooting::Options one = ShootingOptions(options);
  one.num_threads = 1;
  one.communicator = nullptr;
  one.starts.stray_cost = kStrayCost;
  one.looks_ahead = false;
  return one;
}

// True for a factor of which only the sign is determined: the cost is the same
// from a tenth of the estimate to ten times it.
bool IsFlatScale(const ParameterProfile& profile) {
  bool small = false;
  bool large = false;
  for (const ParameterProfile::Point& point : profile.points) {
    const double times = point.value / profile.estimate;
    if (!(times > 0.0) || !(std::abs(point.ratio) < kFlat)) continue;
    small = small || times <= kFlatTenth;
    large = large || times >= 1.0 / kFlatTenth;
  }
  return small && large;
}

}  // namespace

Profiler::Profiler(const IdentificationProblem& problem,
                   const ParameterLayout& layout,
                   const IdentificationOptions& options,
                   const std::function<bool()>& stop)
    : layout_(layout),
      stop_(stop),
      objective_(problem, layout, OneThread(options)),
      minimizer_(problem, layout, &objective_) {}

bool Profiler::Place(const IdentificationProblem& problem,
                     const IdentifiedModel& model,
                     const std::vector<RecordScore>& scores) {
  return PlaceAtFit(problem, layout_, model, scores, &objective_);
}

bool Profiler::FindOrigin(const Vector& fit, ProfileOrigin* origin) {
  origin->free = fit;
  if (!objective_.Linearize(fit, &origin->system)) return false;
  HeldMinimum minimum;
  if (!minimizer_.Minimize(
          fit,
          {-1, 0.5 * kRatioTolerance * kChi95, kMostFirstIterations, stop_},
          &minimum)) {
    return false;
  }
  origin->converged = minimum.converged;
  origin->radius = minimizer_.radius();
  if (minimum.system.cost <= origin->system.cost) {
    origin->free = minimum.free;
    origin->system = minimum.system;
  }
  origin->variances = Vector::Zero(fit.size());
  Matrix root, null_space;
  if (InvertInformation(origin->system.hessian, &root, &null_space)) {
    origin->variances = root.rowwise().squaredNorm();
  }
  return true;
}

bool Profiler::Run(const ProfileOrigin& origin, int j, double sigma,
                   double quantile, ParameterProfile* profile) {
  j_ = j;
  origin_ = &origin;
  profile_ = profile;
  profile_->unsettled = !origin.converged;
  // A profile does not depend on the profiles before it.
  minimizer_.set_radius(origin.radius);
  const double variance = origin.variances[j];
  memory_ = sigma > 0.0 && variance > 0.0 ? sigma * sigma / variance : 1.0;
  step_ = std::sqrt(variance * memory_);
  const double stretch = quantile > 0.0 ? quantile * quantile / kChi95 : 1.0;
  profile->threshold95 = stretch * kChi95;
  profile->threshold99 = stretch * kChi99;
  center_ = {origin.free[j], origin.system.cost, origin.free};
  std::vector<Point> path = {center_};
  for (const double side : {-1.0, 1.0}) {
    if (!Walk(side, &path)) return false;
  }
  std::sort(path.begin(), path.end(),
            [](const Point& a, const Point& b) { return a.value < b.value; });
  Conclude(path);
  return true;
}

bool Profiler::Minimize(const Vector& start, int held, HeldMinimum* minimum) {
  const double tolerance = 0.5 * memory_ * kRatioTolerance * kChi95;
  if (!minimizer_.Minimize(start, {held, tolerance, kMostIterations, stop_},
                           minimum)) {
    return false;
  }
  profile_->linearizations += minimum->linearizations;
  profile_->unsettled = profile_->unsettled || !minimum->converged;
  return !(stop_ && stop_());
}

// Returns the square root of the likelihood ratio.
double Profiler::RootOf(double cost) const {
  return std::sqrt(std::max(0.0, 2.0 * (cost - center_.cost) / memory_));
}

// Returns a size of the parameter: its linear deviation, if the data give one
// above rounding. Otherwise its value, or the deviation that it would have if
// all others were known.
double Profiler::Size() const {
  constexpr double kRounding = 1e5;
  const double curvature = origin_->system.hessian(j_, j_);
  const double alone = curvature > 0.0 ? std::sqrt(memory_ / curvature) : 0.0;
  if (step_ > 0.0 && std::isfinite(step_) && step_ < kRounding * alone) {
    return step_;
  }
  return center_.value != 0.0 ? std::abs(center_.value) : 10.0 * alone;
}

bool Profiler::IsFar(double value) const {
  return std::abs(value - center_.value) >
         kFar * std::max(std::abs(center_.value), Size());
}

// True if the cost is unchanged at ten times the estimate, or at a tenth of it.
bool Profiler::IsFlatFor(double root, double value) const {
  const double times = value / center_.value;
  return root * root < kFlat && times > 0.0 &&
         (times <= kFlatTenth || times >= 1.0 / kFlatTenth);
}

// Predicts the minimum at another value from a known one, along the valley or
// straight, whichever looks better. Returns the predicted cost.
double Profiler::Guess(const Point& from, const CondensedSystem& system,
                       double value, Vector* best) {
  const Vector direction = PathDirection(system, j_);
  double least = kInfinity;
  for (Vector start :
       {from.free, Vector(from.free + (value - from.value) * direction),
        AlongProducts(from, direction, value)}) {
    ClampToBounds(&start);
    start[j_] = value;
    double cost = 0.0;
    if (!objective_.Evaluate(start, &cost) || !(cost < least)) continue;
    *best = start;
    least = cost;
  }
  return least;
}

// A valley in which products and quotients are constant is straight in
// logarithms.
Vector Profiler::AlongProducts(const Point& from, const Vector& direction,
                               double value) const {
  Vector start = from.free + (value - from.value) * direction;
  const double times = value / from.value;
  if (!(times > 0.0) || !std::isfinite(times)) return start;
  for (int k = 0; k < start.size(); ++k) {
    const double power = direction[k] * from.value / from.free[k];
    if (!std::isfinite(power) || std::abs(power) > kMostPower) continue;
    start[k] = from.free[k] * std::pow(times, power);
  }
  return start;
}

// Appends the points on one side, outwards. Returns false if it was stopped.
bool Profiler::Walk(double side, std::vector<Point>* path) {
  const Parameter& parameter = layout_.free_parameter(j_);
  const double bound = side < 0.0 ? parameter.lower : parameter.upper;
  const double aims[] = {std::sqrt(profile_->threshold95),
                         std::sqrt(profile_->threshold99)};
  Point last = center_;
  CondensedSystem system = origin_->system;
  double root = 0.0;
  double slope = Size() > 0.0 ? 1.0 / Size() : 0.0;
  double longest = 2.0 * aims[0] * Size();
  int jumps = 0;
  for (int i = 0; i < kMostPoints && last.value != bound; ++i) {
    const double aim = 1.02 * (root < aims[0] ? aims[0] : aims[1]);
    double way = slope > 0.0 ? (aim - root) / slope : longest;
    way = std::clamp(way, 1e-3 * longest, longest);
    if (!(way > 0.0)) break;
    double value = last.value + side * way;
    if (side * (value - bound) > 0.0) value = bound;
    way = std::abs(value - last.value);
    HeldMinimum minimum;
    Vector start;
    const bool is_hopeless =
        RootOf(Guess(last, system, value, &start)) > kHopeless * aims[1];
    const bool solved = start.size() > 0 &&
                        !(is_hopeless && jumps < kMostJumps) &&
                        Minimize(start, j_, &minimum);
    if (stop_ && stop_()) return false;
    const double new_root = solved ? RootOf(minimum.system.cost) : kInfinity;
    // The cost rises far too much at once: a wall, or a bent valley. Shorter
    // steps distinguish them.
    if (new_root > 2.0 * aims[1] && jumps < kMostJumps) {
      ++jumps;
      longest = 0.25 * way;
      slope = 0.0;
      continue;
    }
    if (!solved) break;
    slope = (new_root - root) / way;
    longest = jumps > 0 ? 2.0 * way : 3.0 * std::abs(value - center_.value);
    last = {value, minimum.system.cost, minimum.free};
    system = minimum.system;
    root = new_root;
    path->push_back(last);
    if (root >= aims[1] || IsFar(value) || IsFlatFor(root, value)) break;
  }
  return Refine(side, path);
}

// Adds points near the thresholds if steps have passed over them.
bool Profiler::Refine(double side, std::vector<Point>* path) {
  for (const double threshold :
       {profile_->threshold95, profile_->threshold99}) {
    const double aim = std::sqrt(threshold);
    for (int i = 0; i < 4; ++i) {
      std::sort(path->begin(), path->end(),
                [side](const Point& a, const Point& b) {
                  return side * a.value < side * b.value;
                });
      // First point beyond, and the one before it on this side.
      size_t k = 0;
      const auto is_here = [&](const Point& point) {
        return side * (point.value - center_.value) > 0.0;
      };
      while (k < path->size() &&
             (!is_here((*path)[k]) || RootOf((*path)[k].cost) < aim)) {
        ++k;
      }
      if (k == path->size()) break;
      const Point& beyond = (*path)[k];
      const Point& before =
          k > 0 && is_here((*path)[k - 1]) ? (*path)[k - 1] : center_;
      const double high = RootOf(beyond.cost);
      const double low = RootOf(before.cost);
      if (high - aim < kNear * aim || aim - low < kNear * aim) break;
      const double share = std::clamp((aim - low) / (high - low), 0.3, 0.9);
      Vector start = before.free + share * (beyond.free - before.free);
      HeldMinimum minimum;
      if (!Minimize(start, j_, &minimum)) return !(stop_ && stop_());
      path->push_back({minimum.free[j_], minimum.system.cost, minimum.free});
    }
  }
  return true;
}

void Profiler::ClampToBounds(Vector* free) const {
  for (int k = 0; k < free->size(); ++k) {
    const Parameter& parameter = layout_.free_parameter(k);
    (*free)[k] = std::clamp((*free)[k], parameter.lower, parameter.upper);
  }
}

// Returns the value at which the root reaches `aim` on one side of the
// estimate.
double Profiler::EndOf(double side, double aim,
                       const std::vector<Point>& path) const {
  double value = center_.value;
  double root = 0.0;
  const auto pass = [&](const Point& point, double* end) {
    if (side * (point.value - center_.value) <= 0.0) return false;
    const double next = RootOf(point.cost);
    if (next >= aim) {
      *end = value + (point.value - value) * (aim - root) / (next - root);
      return true;
    }
    value = point.value;
    root = next;
    return false;
  };
  double end = side * kInfinity;
  if (side > 0.0) {
    for (const Point& point : path) {
      if (pass(point, &end)) break;
    }
  } else {
    for (auto point = path.rbegin(); point != path.rend(); ++point) {
      if (pass(*point, &end)) break;
    }
  }
  return end;
}

void Profiler::Conclude(const std::vector<Point>& path) {
  ParameterProfile& profile = *profile_;
  profile.estimate = center_.value;
  double largest = 0.0;
  for (const Point& point : path) {
    const double ratio = 2.0 * (point.cost - center_.cost) / memory_;
    profile.points.push_back({point.value, ratio});
    profile.found_lower = profile.found_lower || ratio < -kFlat;
    largest = std::max(largest, ratio);
  }
  const double aim95 = std::sqrt(profile.threshold95);
  const double aim99 = std::sqrt(profile.threshold99);
  profile.lower95 = EndOf(-1.0, aim95, path);
  profile.upper95 = EndOf(1.0, aim95, path);
  profile.lower99 = EndOf(-1.0, aim99, path);
  profile.upper99 = EndOf(1.0, aim99, path);
  const int ends = (std::isfinite(profile.lower95) ? 1 : 0) +
                   (std::isfinite(profile.upper95) ? 1 : 0);
  profile.determination = largest < kFlat || IsFlatScale(profile)
                              ? Determination::kNotAtAll
                          : ends == 2 ? Determination::kDetermined
                          : ends == 1 ? Determination::kOneSided
                                      : Determination::kNotHere;
  if (profile.determination != Determination::kDetermined) {
    NameCombinations(path);
  }
}

// Names the combinations that are constant along points that the data do not
// distinguish from the estimate.
void Profiler::NameCombinations(const std::vector<Point>& path) {
  std::vector<std::string> names;
  std::vector<int> columns;
  for (int k = 0; k < layout_.num_free(); ++k) {
    if (!layout_.IsNamed(layout_.free()[static_cast<size_t>(k)])) continue;
    columns.push_back(k);
    names.push_back(layout_.free_parameter(k).name);
  }
  std::vector<const Point*> same;
  for (const Point& point : path) {
    if (RootOf(point.cost) < std::sqrt(profile_->threshold95)) {
      same.push_back(&point);
    }
  }
  Matrix values(static_cast<Eigen::Index>(columns.size()),
                static_cast<Eigen::Index>(same.size()));
  int along = 0;
  for (size_t k = 0; k < columns.size(); ++k) {
    if (columns[k] == j_) along = static_cast<int>(k);
    for (size_t p = 0; p < same.size(); ++p) {
      values(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(p)) =
          same[p]->free[columns[k]];
    }
  }
  profile_->combinations = DescribeCombinations(names, values, along);
}

}  // namespace pinode
