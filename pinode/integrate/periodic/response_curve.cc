#include "pinode/integrate/periodic/response_curve.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

// Newton's iterations of one point, and the residual at which they end,
// relative to the unknowns.
constexpr int kMostNewtonSteps = 12;
constexpr double kConverged = 1e-11;
// Stands for the norm of a response that is zero.
constexpr double kTiny = 1e-300;

// A point of the curve: unknowns and frequency.
struct Point {
  Vector unknowns;
  double omega = 0.0;
};

// Returns a tangent for another number of unknowns, with its last entry, that
// of the frequency, at the end.
Vector Resized(const Vector& tangent, Eigen::Index unknowns) {
  const Eigen::Index kept = std::min(unknowns, tangent.size() - 1);
  Vector result = Vector::Zero(unknowns + 1);
  result.head(kept) = tangent.head(kept);
  result[unknowns] = tangent[tangent.size() - 1];
  return result;
}

// Follows one curve.
class Follower {
 public:
  Follower(const ResponseCurveOptions& options, HarmonicBalance* balance)
      : options_(options),
        balance_(balance),
        harmonics_(options.harmonics),
        range_(std::abs(options.to - options.from)) {}

  bool Run(std::string* error);

 private:
  // A step along the curve changes the frequency by at most 1 / (num_points -
  // 1) of the range, and the unknowns by at most this share of their norm.
  static constexpr double kLargestChange = 0.1;
  double Scale(const Vector& unknowns) const {
    return std::max(unknowns.norm(), kTiny) * kLargestChange *
           (options_.num_points - 1);
  }
  // Corrects the point along the hyperplane through it that is normal to
  // `tangent`, in scaled units; at a fixed frequency if `tangent` is empty.
  bool Correct(const Vector& tangent, double scale, Point* point);
  // Returns the unit tangent at a solution, with a positive product with
  // `before`, or towards options.to without one.
  Vector Tangent(const Point& point, double scale, const Vector& before);
  bool Begin(Point* point);
  // Adds harmonics until the next ones do not matter.
  void Refine(Point* point);
  // Drops those that were added if they are not needed any more.
  void Coarsen(Point* point);
  // Hands the point over. Returns false if the curve is to end.
  bool Show(const Point& point);
  void Pad(int harmonics, Vector* vector) const;
  // True if the frequency lies between the ends.
  bool IsInside(double omega) const {
    return (omega - options_.from) * (omega - options_.to) <= 0.0;
  }

  bool IsBeyondEnd(double omega) const {
    return !IsInside(omega) &&
           std::abs(omega - options_.to) < std::abs(omega - options_.from);
  }

  const ResponseCurveOptions& options_;
  HarmonicBalance* balance_;
  int harmonics_;
  double range_;
  HarmonicBalance::Equations equations_;
  int iterations_ = 0;
  int num_points_ = 0;
};

bool Follower::Correct(const Vector& tangent, double scale, Point* point) {
  const Point predicted = *point;
  const Eigen::Index n = point->unknowns.size();
  const bool fixed = tangent.size() == 0;
  for (iterations_ = 0; iterations_ < kMostNewtonSteps; ++iterations_) {
    if (!(point->omega > 0.0) ||
        !balance_->Evaluate(harmonics_, point->omega, point->unknowns,
                            &equations_)) {
      return false;
    }
    const double along =
        fixed ? 0.0
              : tangent.head(n).dot(point->unknowns - predicted.unknowns) /
                        scale +
                    tangent[n] * (point->omega - predicted.omega) / range_;
    if (equations_.residual.norm() <=
            kConverged * std::max(point->unknowns.norm(), kTiny) &&
        std::abs(along) <= kConverged) {
      return true;
    }
    if (fixed) {
      point->unknowns -=
          equations_.jacobian.partialPivLu().solve(equations_.residual);
      continue;
    }
    Matrix system(n + 1, n + 1);
    system << equations_.jacobian * scale, equations_.by_omega * range_,
        tangent.transpose();
    Vector right(n + 1);
    right << equations_.residual, along;
    const Vector step = system.partialPivLu().solve(right);
    if (!step.allFinite()) return false;
    point->unknowns -= scale * step.head(n);
    point->omega -= range_ * step[n];
  }
  return false;
}

Vector Follower::Tangent(const Point& point, double scale,
                         const Vector& before) {
  const Eigen::Index n = point.unknowns.size();
  Vector tangent = Vector::Zero(n + 1);
  if (!balance_->Evaluate(harmonics_, point.omega, point.unknowns,
                          &equations_)) {
    return tangent;
  }
  Vector last = Vector::Unit(n + 1, n);
  if (before.size() == n + 1) {
    last = before;
  } else {
    last[n] = options_.to > options_.from ? 1.0 : -1.0;
  }
  Matrix system(n + 1, n + 1);
  system << equations_.jacobian * scale, equations_.by_omega * range_,
      last.transpose();
  tangent = system.partialPivLu().solve(Vector::Unit(n + 1, n));
  return tangent.allFinite() ? Vector(tangent.normalized()) : last;
}

// From small loads on, where the response is nearly linear, to the whole load.
bool Follower::Begin(Point* point) {
  constexpr double kSmallestStep = 1.0 / 256.0;
  point->omega = options_.from;
  point->unknowns = Vector::Zero(balance_->num_unknowns(harmonics_));
  double reached = 0.0;
  double step = 1.0;
  while (reached < 1.0) {
    const double next = std::min(1.0, reached + step);
    balance_->SetScale(next);
    Point trial = *point;
    if (reached > 0.0) trial.unknowns *= next / reached;
    if (Correct({}, 1.0, &trial)) {
      *point = std::move(trial);
      reached = next;
      step *= 2.0;
    } else {
      step /= 2.0;
      if (step < kSmallestStep) return false;
    }
  }
  return true;
}

void Follower::Pad(int harmonics, Vector* vector) const {
  const Eigen::Index before = vector->size();
  vector->conservativeResize(balance_->num_unknowns(harmonics));
  vector->tail(vector->size() - before).setZero();
}

void Follower::Refine(Point* point) {
  // A system of so many unknowns takes about a second.
  constexpr int kMostUnknowns = 4000;
  while (equations_.neglected > options_.tolerance &&
         harmonics_ < options_.most_harmonics) {
    const int before = harmonics_;
    const double neglected = equations_.neglected;
    harmonics_ = std::min(2 * harmonics_ + 1, options_.most_harmonics);
    Point finer = *point;
    if (balance_->num_unknowns(harmonics_) <= kMostUnknowns) {
      Pad(harmonics_, &finer.unknowns);
      if (Correct({}, 1.0, &finer)) {
        *point = std::move(finer);
        continue;
      }
    }
    // Near a point at which the curve turns back, the next point may do.
    harmonics_ = before;
    equations_.neglected = neglected;
    return;
  }
}

void Follower::Coarsen(Point* point) {
  // So much smaller than the tolerance, they will not be added again at once.
  constexpr double kNotNeeded = 1e-2;
  const int fewer = harmonics_ / 2;
  if (fewer < options_.harmonics) return;
  const Eigen::Index kept = balance_->num_unknowns(fewer);
  const Vector dropped = point->unknowns.tail(point->unknowns.size() - kept);
  if (dropped.norm() >
      kNotNeeded * options_.tolerance * point->unknowns.norm()) {
    return;
  }
  harmonics_ = fewer;
  point->unknowns.conservativeResize(kept);
}

bool Follower::Show(const Point& point) {
  ++num_points_;
  return options_.each(
      {point.omega,
       balance_->StateCoefficients(harmonics_, point.omega, point.unknowns),
       equations_.neglected,
       balance_->LargestMultiplier(harmonics_, point.omega, point.unknowns)});
}

bool Follower::Run(std::string* error) {
  // A step that needs few iterations is lengthened, one that needs many
  // shortened. Turns of a curve between few points need this much shorter ones.
  constexpr int kFewIterations = 3;
  constexpr int kManyIterations = 6;
  constexpr double kShortest = 1e-5;
  // At the fixed last frequency, a solution farther away is of another branch.
  constexpr double kFarthestEnd = 3.0;
  // A response that turns back often, such as one with many modes, ends too.
  const int most_points = 20 * options_.num_points;
  Point point;
  if (!Begin(&point)) {
    *error =
        "no periodic response was found at the first frequency; begin far from "
        "a resonance, or with a smaller amplitude";
    return false;
  }
  Refine(&point);
  if (!Show(point)) return true;
  const double longest = 1.0 / (options_.num_points - 1);
  double length = longest;
  double scale = Scale(point.unknowns);
  Vector tangent = Tangent(point, scale, {});
  while (num_points_ < most_points) {
    const Eigen::Index n = point.unknowns.size();
    Point next;
    next.unknowns = point.unknowns + length * scale * tangent.head(n);
    next.omega = point.omega + length * range_ * tangent[n];
    // The last point is the end of the range.
    bool is_last = IsBeyondEnd(next.omega);
    if (is_last) next.omega = options_.to;
    bool found = Correct(is_last ? Vector() : tangent, scale, &next);
    if (found && IsBeyondEnd(next.omega)) {
      is_last = true;
      next.omega = options_.to;
      found = Correct({}, scale, &next);
    }
    if (!found || (is_last && (next.unknowns - point.unknowns).norm() >
                                  kFarthestEnd * length * scale)) {
      length *= 0.5;
      if (length < kShortest * longest) {
        *error =
            "the curve could not be followed beyond an angular frequency of " +
            FormatNumber(point.omega, 6);
        return false;
      }
      continue;
    }
    if (iterations_ <= kFewIterations) {
      length = std::min(1.5 * length, longest);
    } else if (iterations_ >= kManyIterations) {
      length *= 0.5;
    }
    if (!IsInside(next.omega)) {
      *error =
          "the curve turned back to the first frequency; begin at another one, "
          "or sweep the other way";
      return false;
    }
    Refine(&next);
    tangent = Resized(tangent, next.unknowns.size());
    point = std::move(next);
    if (!Show(point) || is_last) return true;
    Coarsen(&point);
    tangent = Resized(tangent, point.unknowns.size());
    scale = Scale(point.unknowns);
    tangent = Tangent(point, scale, tangent);
  }
  *error = "the curve turns back too often: it is not finished after " +
           std::to_string(most_points) + " points";
  return false;
}

}  // namespace

bool FollowResponseCurve(const ResponseCurveOptions& options,
                         HarmonicBalance* balance, std::string* error) {
  return Follower(options, balance).Run(error);
}

}  // namespace pinode
