#include "pinode/record/frf/frf_estimate.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/statistics.h"
#include "pinode/base/strings.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

// Blocks of random forces that are averaged, and limits of their samples.
constexpr Index kBlocksWanted = 16;
constexpr Index kSmallestBlock = 64;
constexpr Index kLargestBlock = 65536;
// Samples that any block needs.
constexpr Index kFewestBlockSamples = 4;
// Inverse of 1 - coherence between forces from which they are one force.
constexpr double kOneForce = 1e8;
// Power of a line relative to the largest one below which a periodic force has
// no such line.
constexpr double kNoPeriodicForce = 1e-6;

// Spectra of the forces x and the responses y, averaged over the blocks. Those
// between responses are not kept.
struct FrfSpectra {
  std::vector<ComplexMatrix> xx;  // of each line, references x references
  std::vector<ComplexMatrix> yx;  // responses x references
  Matrix yy;                      // lines x responses
  // Means of the transforms, for a periodic force.
  ComplexMatrix mean_x, mean_y;  // lines x channels

  FrfSpectra(Index lines, Index references, Index responses)
      : xx(static_cast<size_t>(lines),
           ComplexMatrix::Zero(references, references)),
        yx(static_cast<size_t>(lines),
           ComplexMatrix::Zero(responses, references)),
        yy(Matrix::Zero(lines, responses)),
        mean_x(ComplexMatrix::Zero(lines, references)),
        mean_y(ComplexMatrix::Zero(lines, responses)) {}

  Index num_lines() const { return yy.rows(); }

  // `x`, `y`: lines x channels.
  void Add(const ComplexMatrix& x, const ComplexMatrix& y, double weight) {
    for (Index k = 0; k < num_lines(); ++k) {
      const ComplexVector force = x.row(k).transpose();
      const ComplexVector motion = y.row(k).transpose();
      xx[static_cast<size_t>(k)] += weight * force * force.adjoint();
      yx[static_cast<size_t>(k)] += weight * motion * force.adjoint();
      yy.row(k) += weight * motion.cwiseAbs2().transpose();
    }
    mean_x += weight * x;
    mean_y += weight * y;
  }
};

// Number of independent blocks among `count` that overlap.
double IndependentBlocks(const Vector& window, Index step, Index count) {
  const double n = static_cast<double>(count);
  double sum = 1.0;
  for (Index j = 1; j < count && j * step < window.size(); ++j) {
    const Index rest = window.size() - j * step;
    const double product = window.head(rest).dot(window.tail(rest));
    const double correlation = product / window.squaredNorm();
    sum += 2.0 * (1.0 - static_cast<double>(j) / n) * correlation * correlation;
  }
  return n / sum;
}

class FrfEstimation {
 public:
  FrfEstimation(const std::vector<ForcedRecord>& records,
                const FrfEstimateOptions& options, FrfEstimate* estimate,
                std::string* error)
      : records_(records),
        options_(options),
        result_(*estimate),
        error_(error) {}

  bool Run() {
    if (!Check() || !FindBlocks()) return false;
    result_.block_seconds = static_cast<double>(block_) * step();
    FrfSpectra spectra(NumLines(), num_references(), num_responses());
    AddBlocks(&spectra);
    return Solve(spectra);
  }

 private:
  Index num_references() const { return records_[0].forces.rows(); }
  Index num_responses() const { return records_[0].responses.rows(); }
  double step() const { return records_[0].sampling_step; }
  // Without 0 Hz, where means are removed, and half the sampling rate, where
  // transforms are real.
  Index NumLines() const { return (block_ + 1) / 2 - 1; }
  bool Fail(const std::string& message) {
    *error_ = message;
    return false;
  }

  bool Check() {
    if (records_.empty()) return Fail("there is no record with a force");
    for (const ForcedRecord& record : records_) {
      const std::string begin = "record '" + record.name + "': ";
      if (record.forces.rows() == 0 || record.responses.rows() == 0) {
        return Fail(begin + "expected at least one force and one response");
      }
      if (record.forces.cols() != record.responses.cols()) {
        return Fail(begin + "forces and responses differ in their samples");
      }
      if (record.forces.rows() != num_references() ||
          record.responses.rows() != num_responses() ||
          std::abs(record.sampling_step - step()) > 1e-9 * step()) {
        return Fail(begin +
                    "has other channels or another step than the record "
                    "before; give it in a command of its own");
      }
      if (!record.forces.allFinite() || !record.responses.allFinite()) {
        return Fail(begin + "has missing samples; give a window without gaps");
      }
      for (const Matrix* rows : {&record.forces, &record.responses}) {
        for (Index i = 0; i < rows->rows(); ++i) {
          if (rows->row(i).maxCoeff() > rows->row(i).minCoeff()) continue;
          return Fail(begin +
                      (rows == &record.forces ? "a force" : "a response") +
                      " never changes; leave it out");
        }
      }
    }
    if (!(options_.overlap >= 0.0) || !(options_.overlap < 1.0)) {
      return Fail("overlap is " + FormatNumber(options_.overlap, 3) +
                  ", expected a share from 0 to below 1");
    }
    if (options_.estimator == FrfEstimator::kH2 && num_references() > 1) {
      return Fail("H2 is for one force; use h1 or hv for several");
    }
    return true;
  }

  bool FindBlocks() {
    result_.excitation = options_.excitation;
    if (options_.excitation == FrfExcitation::kAutomatic) {
      result_.excitation =
          HasBlows(records_) ? FrfExcitation::kBlows : FrfExcitation::kRandom;
    }
    if (options_.exponential_window > 0.0) {
      if (result_.excitation != FrfExcitation::kBlows) {
        return Fail(
            "exponential_window is for blows of a hammer; leave it out for "
            "other forces");
      }
      result_.decay_rate = 1.0 / options_.exponential_window;
    }
    if (options_.force_window > 0.0 &&
        result_.excitation != FrfExcitation::kBlows) {
      return Fail(
          "force_window is for blows of a hammer; leave it out for other "
          "forces");
    }
    if (result_.excitation == FrfExcitation::kBlows) return FindBlowBlocks();
    return result_.excitation == FrfExcitation::kPeriodic ? FindPeriods()
                                                          : FindRandomBlocks();
  }

  bool FindBlowBlocks() {
    BlowSearch search;
    if (!FindBlows(records_, options_.block_samples,
                   result_.decay_rate * step(), &search, error_)) {
      return false;
    }
    blocks_ = std::move(search.blocks);
    block_ = search.block_samples;
    result_.remarks = std::move(search.remarks);
    result_.num_averages = static_cast<double>(blocks_.size());
    result_.shortest_rest = static_cast<double>(search.shortest_rest) * step();
    window_ = Vector::Ones(block_);
    for (Index k = 0; k < block_; ++k) {
      window_[k] =
          std::exp(-result_.decay_rate * step() * static_cast<double>(k));
    }
    force_window_ = window_;
    if (!(options_.force_window > 0.0)) return true;
    const Index end = static_cast<Index>(
        std::min(options_.force_window / step(), static_cast<double>(block_)));
    const Index taper = std::max<Index>(1, end / 4);
    for (const FrfBlock& block : blocks_) {
      if (block.pulse_end <= end) continue;
      return Fail(
          "force_window ends before a blow does, expected at least " +
          FormatNumber(static_cast<double>(block.pulse_end) * step(), 3) +
          " s");
    }
    for (Index k = end; k < block_; ++k) {
      const double part =
          static_cast<double>(k - end) / static_cast<double>(taper);
      force_window_[k] *= part < 1.0 ? 0.5 + 0.5 * std::cos(kPi * part) : 0.0;
    }
    return true;
  }

  bool FindRandomBlocks() {
    Index samples = records_[0].forces.cols();
    for (const ForcedRecord& record : records_) {
      samples = std::min(samples, record.forces.cols());
    }
    block_ = options_.block_samples;
    if (block_ == 0) {
      block_ = kSmallestBlock;
      while (block_ < kLargestBlock &&
             2 * block_ <= 2 * samples / (kBlocksWanted + 1)) {
        block_ *= 2;
      }
    }
    if (block_ > samples || block_ < kFewestBlockSamples) {
      return Fail("a block has " + std::to_string(block_) +
                  " samples, expected 4 to the " + std::to_string(samples) +
                  " of a record");
    }
    window_.resize(block_);
    for (Index k = 0; k < block_; ++k) {
      window_[k] = 0.5 - 0.5 * std::cos(kTwoPi * static_cast<double>(k) /
                                        static_cast<double>(block_));
    }
    force_window_ = window_;
    const Index shared = static_cast<Index>(
        std::floor(options_.overlap * static_cast<double>(block_)));
    const Index apart = std::max<Index>(1, block_ - shared);
    for (size_t r = 0; r < records_.size(); ++r) {
      Index count = 0;
      for (Index first = 0; first + block_ <= records_[r].forces.cols();
           first += apart) {
        blocks_.push_back({r, first, 0});
        ++count;
      }
      result_.num_averages += IndependentBlocks(window_, apart, count);
    }
    return true;
  }

  bool FindPeriods() {
    block_ = options_.block_samples;
    if (num_references() > 1) {
      return Fail("periodic excitation is for one force; use random");
    }
    if (block_ < kFewestBlockSamples) {
      return Fail(
          "periodic excitation needs its period: set block to it, in s");
    }
    window_ = force_window_ = Vector::Ones(block_);
    for (size_t r = 0; r < records_.size(); ++r) {
      for (Index first = block_; first + block_ <= records_[r].forces.cols();
           first += block_) {
        blocks_.push_back({r, first, 0});
      }
    }
    if (blocks_.empty()) {
      return Fail(
          "no record has two periods, expected more, the first of which is "
          "left out");
    }
    result_.num_averages = static_cast<double>(blocks_.size());
    return true;
  }

  // Offsets of the channels over a record with blows. Their means are not zero:
  // a pulse has none, nor has a vibration that begins with it.
  static Vector OffsetsOf(const Matrix& rows) {
    Vector offsets(rows.rows());
    for (Index i = 0; i < rows.rows(); ++i) {
      const Vector values = rows.row(i);
      offsets[i] = Median({values.begin(), values.end()});
    }
    return offsets;
  }

  ComplexMatrix Transform(const Matrix& rows, const Vector& offsets,
                          const Vector& window, Index first) {
    ComplexMatrix transforms(NumLines(), rows.rows());
    ComplexVector transform;
    for (Index i = 0; i < rows.rows(); ++i) {
      Vector values = rows.row(i).segment(first, block_);
      values.array() -= result_.excitation == FrfExcitation::kRandom
                            ? values.mean()
                            : offsets[i];
      values.array() *= window.array();
      fft_.fwd(transform, values);
      transforms.col(i) = transform.segment(1, NumLines());
    }
    return transforms;
  }

  void AddBlocks(FrfSpectra* spectra) {
    result_.num_blocks = static_cast<int>(blocks_.size());
    const double weight = 1.0 / static_cast<double>(blocks_.size());
    size_t record = records_.size();
    Vector force_offsets, response_offsets;
    for (const FrfBlock& block : blocks_) {
      const ForcedRecord& own = records_[block.record];
      if (block.record != record) {
        record = block.record;
        force_offsets = OffsetsOf(own.forces);
        response_offsets = OffsetsOf(own.responses);
      }
      spectra->Add(
          Transform(own.forces, force_offsets, force_window_, block.first),
          Transform(own.responses, response_offsets, window_, block.first),
          weight);
    }
  }

  bool Solve(const FrfSpectra& spectra) {
    const Index lines = spectra.num_lines();
    Vector power(lines), least(lines);
    Vector largest = Vector::Zero(num_references());
    for (Index k = 0; k < lines; ++k) {
      const Vector own = spectra.xx[static_cast<size_t>(k)].diagonal().real();
      power[k] = own.maxCoeff();
      least[k] = own.minCoeff();
      largest = largest.cwiseMax(own);
    }
    for (Index j = 0; j < num_references(); ++j) {
      if (largest[j] > 0.0) continue;
      return Fail("force " + std::to_string(j + 1) +
                  " does not act in the blocks; leave it out");
    }
    power /= std::max(1e-300, power.maxCoeff());
    const bool periodic = result_.excitation == FrfExcitation::kPeriodic;
    std::vector<Index> used;
    for (Index k = 0; k < lines; ++k) {
      const bool acts = periodic ? power[k] > kNoPeriodicForce : least[k] > 0.0;
      if (acts) used.push_back(k);
    }
    const Index count = static_cast<Index>(used.size());
    const Index pairs = num_references() * num_responses();
    result_.values.resize(count, pairs);
    result_.frequencies_hz.resize(count);
    result_.force_power = power(used);
    degrees_ = result_.num_averages - static_cast<double>(num_references());
    if (result_.num_blocks > num_references()) {
      result_.variances.resize(count, pairs);
      result_.coherence.resize(count, pairs);
    } else if (num_references() > 1) {
      return Fail(std::to_string(result_.num_blocks) + " blocks for " +
                  std::to_string(num_references()) +
                  " forces, expected more blocks than forces");
    }
    for (Index i = 0; i < count; ++i) {
      const Index k = used[static_cast<size_t>(i)];
      result_.frequencies_hz[i] =
          static_cast<double>(k + 1) / (static_cast<double>(block_) * step());
      if (!(periodic ? SolvePeriodic(spectra, k, i)
                     : SolveLine(spectra, k, i))) {
        return false;
      }
    }
    Say();
    return true;
  }

  bool SolveLine(const FrfSpectra& spectra, Index line, Index to) {
    const ComplexMatrix& xx = spectra.xx[static_cast<size_t>(line)];
    const ComplexMatrix& yx = spectra.yx[static_cast<size_t>(line)];
    const Vector scale = xx.diagonal().real().cwiseSqrt();
    const ComplexMatrix alike = scale.cwiseInverse().asDiagonal() * xx *
                                scale.cwiseInverse().asDiagonal();
    const Eigen::LDLT<ComplexMatrix> factor(alike);
    const ComplexMatrix inverse = factor.solve(
        ComplexMatrix::Identity(num_references(), num_references()));
    if (!(inverse.diagonal().real().maxCoeff() < kOneForce)) {
      return Fail("the forces cannot be told apart at " +
                  FormatNumber(result_.frequencies_hz[to], 4) +
                  " Hz: they are multiples of each other; give one of them, "
                  "or more blocks");
    }
    const ComplexMatrix h1 = yx * scale.cwiseInverse().asDiagonal() * inverse *
                             scale.cwiseInverse().asDiagonal();
    for (Index o = 0; o < num_responses(); ++o) {
      const double rest = std::max(
          0.0, spectra.yy(line, o) - (h1.row(o).dot(yx.row(o))).real());
      for (Index j = 0; j < num_references(); ++j) {
        const double per_force = inverse(j, j).real() / (scale[j] * scale[j]);
        SetUncertainty(h1(o, j), rest * per_force, to, o, j);
      }
      const ComplexVector values =
          EstimateRow(xx, yx.row(o).transpose(), spectra.yy(line, o),
                      h1.row(o).transpose());
      for (Index j = 0; j < num_references(); ++j) {
        result_.values(to, o + num_responses() * j) = values[j];
      }
    }
    return true;
  }

  // `rest`: power of a response that the force does not explain, per power of
  // the force that the others do not explain.
  void SetUncertainty(const Complex& h1, double rest, Index to, Index o,
                      Index j) {
    if (result_.variances.rows() == 0) return;
    const Index pair = o + num_responses() * j;
    const double own = std::norm(h1);
    result_.coherence(to, pair) = own > 0.0 ? own / (own + rest) : 0.0;
    result_.variances(to, pair) = rest / std::max(0.5, degrees_);
  }

  ComplexVector EstimateRow(const ComplexMatrix& xx, const ComplexVector& yx,
                            double yy, const ComplexVector& h1) const {
    if (options_.estimator == FrfEstimator::kH1 || !(yy > 0.0)) return h1;
    if (options_.estimator == FrfEstimator::kH2) {
      return ComplexVector::Constant(1, yy / std::conj(yx[0]));
    }
    const Index count = xx.rows();
    Vector scale(count + 1);
    scale.head(count) = xx.diagonal().real().cwiseSqrt();
    scale[count] = std::sqrt(yy);
    ComplexMatrix all(count + 1, count + 1);
    all.topLeftCorner(count, count) = xx;
    all.row(count).head(count) = yx.transpose();
    all.col(count).head(count) = yx.conjugate();
    all(count, count) = yy;
    const Vector inverse = scale.cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<ComplexMatrix> solver(
        ComplexMatrix(inverse.asDiagonal() * all * inverse.asDiagonal()));
    // v^H z = 0 holds best for the vector of the smallest eigenvalue.
    const ComplexVector v = solver.eigenvectors().col(0);
    ComplexVector values(count);
    for (Index j = 0; j < count; ++j) {
      values[j] = -std::conj(v[j] / v[count]) * scale[count] / scale[j];
    }
    return values;
  }

  bool SolvePeriodic(const FrfSpectra& spectra, Index line, Index to) {
    const Complex x = spectra.mean_x(line, 0);
    for (Index o = 0; o < num_responses(); ++o) {
      const Complex h = spectra.mean_y(line, o) / x;
      const Complex yx = spectra.yx[static_cast<size_t>(line)](o, 0);
      const double xx = spectra.xx[static_cast<size_t>(line)](0, 0).real();
      // Mean square of y - h x over the periods.
      const double rest = spectra.yy(line, o) -
                          2.0 * (std::conj(h) * yx).real() + std::norm(h) * xx;
      result_.values(to, o) = h;
      SetUncertainty(h, std::max(0.0, rest) / std::norm(x), to, o, 0);
    }
    return true;
  }

  void Say() {
    const double averages = result_.num_averages;
    if (result_.coherence.rows() == 0) {
      result_.remarks.push_back(
          "There is one block alone, so there is no coherence.");
    } else if (averages < kFewestAveragesForWeights) {
      result_.remarks.push_back(
          "There are " + FormatNumber(averages, 2) +
          " independent blocks. With fewer than " +
          FormatNumber(kFewestAveragesForWeights, 1) +
          ", the coherence is too uncertain to weight the lines of a fit. "
          "Measure more" +
          (result_.excitation == FrfExcitation::kBlows
               ? " blows."
               : ", or take shorter blocks."));
    }
  }

  const std::vector<ForcedRecord>& records_;
  const FrfEstimateOptions& options_;
  FrfEstimate& result_;
  std::string* error_;
  Index block_ = 0;
  std::vector<FrfBlock> blocks_;
  Vector window_, force_window_;
  double degrees_ = 0.0;
  Eigen::FFT<double> fft_;
};

}  // namespace

bool EstimateFrfs(const std::vector<ForcedRecord>& records,
                  const FrfEstimateOptions& options, FrfEstimate* estimate,
                  std::string* error) {
  *estimate = FrfEstimate();
  return FrfEstimation(records, options, estimate, error).Run();
}

bool FindFrfBlock(const std::vector<ForcedRecord>& records, double seconds,
                  FrfEstimateOptions* options, std::string* error) {
  const double step = records[0].sampling_step;
  Index longest = 0;
  for (const ForcedRecord& record : records) {
    longest = std::max(longest, record.forces.cols());
  }
  const double samples = seconds / step;
  if (!(samples > static_cast<double>(kFewestBlockSamples) - 0.5) ||
      !(samples < static_cast<double>(longest) + 0.5)) {
    *error = "block is " + FormatNumber(seconds, 4) + " s, expected " +
             FormatNumber(static_cast<double>(kFewestBlockSamples) * step, 4) +
             " s (" + std::to_string(kFewestBlockSamples) + " samples) to " +
             FormatNumber(static_cast<double>(longest) * step, 6) +
             " s (the longest record)";
    return false;
  }
  options->block_samples = static_cast<Index>(std::lround(samples));
  if (options->excitation != FrfExcitation::kPeriodic) {
    options->block_samples = FastLength(options->block_samples);
  }
  return true;
}

std::vector<FrequencyResponse> SingleFrfs(
    const FrfEstimate& estimate, const std::string& file,
    const std::vector<std::string>& responses,
    const std::vector<std::string>& references, int derivative) {
  std::vector<FrequencyResponse> all;
  for (Index p = 0; p < estimate.values.cols(); ++p) {
    FrequencyResponse one;
    one.file = file;
    one.response = responses[static_cast<size_t>(p) % responses.size()];
    one.reference = references[static_cast<size_t>(p) / responses.size()];
    one.derivative = derivative;
    one.frequencies_hz = estimate.frequencies_hz;
    one.values = estimate.values.col(p);
    one.decay_rate = estimate.decay_rate;
    // From the derivative along s to that along i w.
    for (Index k = 0; k < one.values.size(); ++k) {
      const Complex w(0.0, kTwoPi * one.frequencies_hz[k]);
      one.values[k] *= std::pow(w / (w + one.decay_rate), derivative);
    }
    if (estimate.coherence.rows() > 0) {
      one.coherence = estimate.coherence.col(p);
    }
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace pinode
