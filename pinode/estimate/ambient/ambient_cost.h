// The likelihood of an ambient record.

#ifndef PINODE_ESTIMATE_AMBIENT_AMBIENT_COST_H_
#define PINODE_ESTIMATE_AMBIENT_AMBIENT_COST_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <memory>
#include <string>
#include <vector>

#include "pinode/base/communicator.h"
#include "pinode/base/types.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/estimate/ambient/ambient_mean.h"
#include "pinode/estimate/solver/cost_part.h"
#include "pinode/problem/ambient_record.h"
#include "pinode/problem/ambient_spectrum.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/structure/model/modal_analysis.h"

namespace pinode {

// Minus the logarithm of Whittle's likelihood of a record's lines Y,
//
//   sum over lines of  log det S_y + Y^H S_y^-1 Y,
//
// as a function of the free groups (those that follow something at its mean
// over the record), the spectrum of the loads and the noise of the channels
// being chosen for each as those that make it smallest: they are nobody's
// question. With W_p = S^-1/2 (dS/dp)
// S^-H/2 and z = S^-1/2 Y,
//
//   gradient  sum tr W_p - z^H W_p z,     information  sum tr(W_p W_q),
//
// of groups, loads and noise together, from which the latter are eliminated.
// Measured loads make Y the record's lines minus those of the response m to
// them, and add -2 Re dm^H S^-1 Y and 2 Re dm^H S^-1 dm.
// Lines within an eighth of a mode's bandwidth are one. Where loads act at
// fewer areas than there are channels, S_y is all but singular, and what the
// transfer function turns within such a line is more than small noise: its mean
// over the line is then taken by two frequencies, right to the third power of
// the width. Work per line: n^3 of the n DOFs for the transfer function,
// areas^4 for the loads, and for each group n^2 times the rank of its matrix.
//
// The frequency domain was taken rather than innovations in time: a spectrum
// that nobody knows needs no filter there, modes beyond the band no model, and
// records of any length no more than their lines.
//
// Sources: P. Whittle (1953); for structures J. L. Beck and L. S. Katafygiotis,
// J. Eng. Mech. 124 (1998) 455, L. S. Katafygiotis and K.-V. Yuen, Earthquake
// Eng. Struct. Dyn. 30 (2001) 1129 (spectral density approach).
class AmbientCost final : public CostPart {
 public:
  // `record` is valid; it and `layout` must outlive this object. The ranks of
  // `communicator` (nullptr: a single process) share the lines, and come to the
  // same bits as one process does.
  AmbientCost(const AmbientRecord& record, const StructuralDynamics& dynamics,
              const ParameterLayout& layout, int num_threads,
              Communicator* communicator = nullptr);

  // Groups of lines.
  Eigen::Index num_lines() const {
    return static_cast<Eigen::Index>(lines_.size());
  }

  [[nodiscard]] bool Evaluate(const Vector& free, double* cost) override;
  [[nodiscard]] bool Linearize(const Vector& free,
                               CondensedSystem* system) override;
  std::string Failure() const override { return failure_; }

  // sum of score^T score over short stretches of neighbouring lines, of the
  // free parameters with loads and noise eliminated, at the last Linearize:
  // what stands between two inverses of the information in a sandwich.
  const Matrix& score_products() const { return score_products_; }
  // The information itself, at the last Linearize.
  const Matrix& information() const { return information_; }

  // At `free`. False where the model fails there.
  [[nodiscard]] bool Score(const Vector& free, AmbientScore* score);

  // Whether the loads' spectrum has as many knots as the record speaks for. The
  // logarithm of the evidence is that of the likelihood, less
  //
  //   1/2 log det(1 + I_0^-1 I),
  //
  // I the information on loads and noise, I_0 what two lines would tell that
  // saw the loads themselves: half the logarithm of how many lines say so for
  // each number that the record tells, nothing for one that it does not. What
  // finer loads leave of the groups does not count for them. What a knot
  // between any two would add to the likelihood is that of one step of scoring
  // from where they change nothing, groups free: 1/2 g^T I^-1 g, but for what
  // holds the covariances. (C. R. Rao, Proc. Camb. Phil. Soc. 44 (1948) 50;
  // evidence with the information of a few data for the prior's: R. E. Kass and
  // L. Wasserman, J. Amer. Statist. Assoc. 90 (1995) 928.)
  LoadEvidence JudgeLoads(const Vector& free);

 private:
  // A free group and what it adds to.
  struct Column {
    int free = -1;
    MatrixGroup::Target target = MatrixGroup::Target::kStiffness;
    // Its matrix is left right^T, num_dofs x rank; of full rank it is `left`
    // itself, and `right` empty.
    Matrix left, right;
  };
  // By loads and noise, then groups.
  struct Sums {
    Vector gradient;
    Matrix information;
    Matrix products;  // of scores, with groups and unless nobody wants them
    bool with_products = true;
  };
  struct IntervalSums;
  // Of a piece of the band.
  struct PieceSums;
  class LineSums;

  // The band is summed in so many pieces, whoever has them, so that sums are
  // the same.
  static constexpr int kPieces = 16;
  // Lines of the loads themselves that what holds covariances stands for.
  static constexpr double kPriorLines = 2.0;
  // What a line tells of the noise, whose unknown is half its logarithm.
  static constexpr double kMetricOfNoise = 4.0;
  Eigen::Index FirstLine(int piece) const {
    return num_lines() * Eigen::Index{piece} / kPieces;
  }
  // Whose a piece is.
  int RankOf(int piece) const { return piece * communicator_.size() / kPieces; }

  // All of a score that needs no line, and room for the rest.
  AmbientScore BlankScore() const;
  // The model at `free`; notes why where there is none.
  [[nodiscard]] bool SetModel(const Vector& free);
  // n x n at a frequency, factorised.
  Eigen::PartialPivLU<Eigen::MatrixXcd> DynamicStiffness(
      double frequency) const;
  // At which a line's spectrum is taken.
  double NodeFrequency(Eigen::Index line, int node) const;
  // Of displacements to what the channels measure, over their scales.
  Eigen::VectorXcd ChannelFactors(double frequency) const;
  // Where forces act, as the record says or leaves to be found.
  void SetLoads(const ModalProperties& modes, double highest);
  // Of all lines, or of those of this rank's pieces.
  void FindTransfer(bool all);
  // Cost, and where `sums` is not null its derivatives by loads and noise, with
  // those by the groups behind them where asked for.
  [[nodiscard]] bool Accumulate(bool with_groups, double* cost,
                                Sums* sums) const;
  [[nodiscard]] bool AccumulateLines(Eigen::Index first, Eigen::Index last,
                                     bool with_groups, double* cost,
                                     std::vector<IntervalSums>* sums) const;
  // Makes known to all ranks what each has found of its pieces. False where one
  // does not answer.
  [[nodiscard]] bool Exchange(bool with_sums, bool with_groups,
                              std::vector<PieceSums>* pieces) const;
  void AddInterval(const IntervalSums& interval, Sums* sums) const;
  // Of the loads at each knot, areas x areas.
  std::vector<Matrix> KnotCovariances() const;
  // Of the loads at a frequency.
  Matrix LoadCovariance(double frequency,
                        const std::vector<Matrix>& at_knots) const;
  // S_y of a line where the loads have a covariance; false where it is not
  // positive definite.
  [[nodiscard]] bool FactorizeLine(Eigen::Index line, const Matrix& loads,
                                   Eigen::LLT<Eigen::MatrixXcd>* factor) const;
  // Loads and noise for the transfer function as it is, until a step promises
  // next to nothing of the cost, which is taken off it; roughly, where they are
  // not known at all.
  [[nodiscard]] bool FitUnknowns(double* cost);
  // The same from nothing: loads that have nothing in common first, which are
  // then what covariances are held to.
  [[nodiscard]] bool FirstUnknowns(double* cost);
  void StartUnknowns();
  // Adds what prior_ costs.
  void AddPrior(double* cost, Sums* sums) const;
  // The same of nothing.
  Sums PriorSums(double* cost) const;
  // The unknowns after a step; noise moves in its variance and vanishes in no
  // step.
  Vector Moved(const Vector& unknowns, const Vector& step) const;
  // Noise that would vanish takes no part any more.
  void HoldNoise(Sums* sums) const;
  // Unknowns that the record determines: all but what the prior does.
  double NumFitted() const;
  // What a line would tell that saw all loads themselves, and of the noise of
  // each channel: a measure of relative changes. Size of the unknowns; of a
  // knot's loads.
  Matrix RelativeMetric() const;
  Matrix MetricOfKnot(int knot) const;
  // What prior_ itself says of loads and noise.
  Matrix PriorInformation() const { return PriorSums(nullptr).information; }
  // What the evidence takes off for loads and noise of which the likelihood
  // has this information. False where it is none.
  [[nodiscard]] bool PriceOfLoads(Matrix information, double* price) const;
  // Of loads, noise and groups from where `sums` are, held as far as they have
  // to be.
  [[nodiscard]] bool StepOfLoads(const Sums& sums, Vector* step) const;
  // The rest of JudgeLoads, with spectrum_, unknowns_ and prior_ those of the
  // finer spectrum. False where it cannot be told.
  [[nodiscard]] bool PromiseOfLoads(double* gain, double* price) const;
  // What of the information on the groups is left where loads and noise are
  // unknown, without what the prior says of them.
  void FindInformationLeft(const Matrix& information);
  int num_nuisance() const { return static_cast<int>(unknowns_.size()); }

  const AmbientRecord& record_;
  const StructuralDynamics dynamics_;  // averaged over the record
  const ParameterLayout& layout_;
  const int num_threads_;
  Communicator& communicator_;
  // num_dofs x areas, at the last free parameters: forces of unit size, then
  // what accelerations of the base do, -M times base_.
  Matrix loads_;
  Matrix base_;     // num_dofs x directions
  Matrix direct_;   // channels x areas: of the base in absolute accelerations
  Matrix sensors_;  // channels x num_dofs
  Vector derivatives_;                 // 0, 1, 2 of each channel
  Vector scales_;                      // of the channels
  std::unique_ptr<AmbientMean> mean_;  // nullptr: no load is measured
  std::vector<Column> columns_;
  LineGroups lines_;  // over the scales; minus mean_ at the last model
  double total_lines_ = 0.0;
  std::unique_ptr<LoadSpectrum> spectrum_;
  // Intensities of the loads at the knots, areas x knots: covariances are as if
  // a few lines of the loads themselves had been seen with these. Forces on a
  // mode far from a knot tell nothing of themselves there, and an estimate
  // alone would find them perfectly correlated. Empty: none.
  Matrix prior_;
  // Noise below it makes no difference, of what measured loads leave; densities
  // over the scales.
  Vector smallest_noise_;
  double offset_ = 0.0;                // makes the cost positive
  Matrix mass_, damping_, stiffness_;  // at the last free parameters
  // Frequencies at which the spectrum of a line is taken, one or two, whose
  // mean it is; per line channels x (areas of each), over the root of their
  // number.
  int num_nodes_ = 1;
  std::vector<Eigen::MatrixXcd> transfer_;
  Vector unknowns_;  // of the loads, then half the logarithms of the noise
  bool unknowns_known_ = false;
  double firmness_ = 0.0;  // of their last step
  // Where they and the transfer functions are those of the least cost.
  Vector evaluated_at_;
  double evaluated_cost_ = 0.0;
  // What a change of the free parameters does to them, at linearized_at_.
  Vector linearized_at_;
  CondensedSystem linearized_;
  Vector unknowns_there_;
  Matrix follow_;
  Matrix score_products_;
  Matrix information_;
  Vector information_left_;  // of columns_
  double most_information_left_ = 1.0;
  std::string failure_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_AMBIENT_AMBIENT_COST_H_
