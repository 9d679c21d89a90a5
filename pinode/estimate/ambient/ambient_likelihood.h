// Whittle's likelihood of an ambient record.

#ifndef PINODE_ESTIMATE_AMBIENT_AMBIENT_LIKELIHOOD_H_
#define PINODE_ESTIMATE_AMBIENT_AMBIENT_LIKELIHOOD_H_

#include <Eigen/Core>
#include <vector>

#include "pinode/estimate/ambient/ambient_lines.h"
#include "pinode/estimate/ambient/ambient_loads.h"
#include "pinode/estimate/ambient/ambient_transfer.h"
#include "pinode/estimate/ambient/line_pieces.h"
#include "pinode/estimate/ambient/line_sums.h"

namespace pinode {

// Derivatives that come with a sum over the lines; each has those before it.
enum class AmbientDerivatives {
  kNone,
  kLoads,   // by the unknowns of loads and noise
  kGroups,  // by the free groups too
  kScores,  // and the products of the scores
};

// Minus the logarithm of the likelihood of a record's lines, for given transfer
// functions and loads, with the prior of the loads; see AmbientCost. The ranks
// share the lines and get the same bits as a single process.
class AmbientLikelihood {
 public:
  // The arguments must outlive this object. It reads them at each call.
  AmbientLikelihood(const AmbientLines& lines, const AmbientTransfer& transfer,
                    const LinePieces& pieces)
      : lines_(lines), transfer_(transfer), pieces_(pieces) {}

  const AmbientLines& lines() const { return lines_; }
  const AmbientTransfer& transfer() const { return transfer_; }

  // Computes the cost and its derivatives; `sums` may be null for kNone. False
  // where the cost is not finite or a rank does not answer.
  [[nodiscard]] bool Sum(const AmbientLoads& loads,
                         AmbientDerivatives derivatives, double* cost,
                         LikelihoodSums* sums) const;

  // Factorises S_y of a line, where the loads have `covariance`. False where it
  // is not positive definite.
  [[nodiscard]] bool FactorizeLine(Eigen::Index line, const AmbientLoads& loads,
                                   const Matrix& covariance,
                                   ComplexFactor* factor) const;

 private:
  struct PieceSums;

  [[nodiscard]] bool SumPiece(const AmbientLoads& loads, int piece,
                              AmbientDerivatives derivatives,
                              PieceSums* sums) const;
  // Sends to all ranks the sums that each has found of its pieces. False where
  // a rank does not answer.
  [[nodiscard]] bool Exchange(const LoadSpectrum& spectrum,
                              AmbientDerivatives derivatives,
                              std::vector<PieceSums>* pieces) const;

  const AmbientLines& lines_;
  const AmbientTransfer& transfer_;
  const LinePieces& pieces_;
};

}  // namespace pinode

#endif  // PINODE_ESTIMATE_AMBIENT_AMBIENT_LIKELIHOOD_H_
