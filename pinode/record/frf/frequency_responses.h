// Frequency response functions (FRFs) of a structure: motion of places per
// force at places, over frequency.

#ifndef PINODE_RECORD_FRF_FREQUENCY_RESPONSES_H_
#define PINODE_RECORD_FRF_FREQUENCY_RESPONSES_H_

#include <string>
#include <vector>

#include "pinode/base/types.h"

namespace pinode {

// One measured FRF.
struct FrequencyResponse {
  std::string file;       // for messages
  std::string response;   // place and direction of the motion; "": not stated
  std::string reference;  // place and direction of the force; "": not stated
  // Measured motion, as the order of its derivative of the displacement. 0:
  // receptance, 1: mobility, 2: accelerance; -1: not stated.
  int derivative = -1;
  Vector frequencies_hz;
  ComplexVector values;
  // Coherence of each line, from 0 to 1; empty: not measured.
  Vector coherence;
  // One over the time constant of an exponential window on force and motion, in
  // 1 / s. The values are (i w)^derivative times the receptance at s = i w +
  // decay_rate, so that the window adds decay_rate to the decay of each pole
  // and leaves residues as they are. 0: no window.
  double decay_rate = 0.0;
};

// All FRFs of a set-up, at the same lines. Column `response + responses.size()
// * reference` of the matrices is one pair.
struct FrequencyResponses {
  std::string name;
  std::vector<std::string> responses;
  std::vector<std::string> references;
  int derivative = 2;
  Vector frequencies_hz;  // ascending
  ComplexMatrix values;   // lines x pairs
  // Variance of each value relative to the others of its pair, from its
  // coherence; no rows: not known.
  Matrix variances;
  // Coherence of each value; no rows: not known.
  Matrix coherence;
  // Decay rate of all functions, see FrequencyResponse.
  double decay_rate = 0.0;
  // File of each pair, as its number in a list of files.
  std::vector<int> files;
  // Assumptions made on reading, one sentence each.
  std::vector<std::string> remarks;

  Eigen::Index num_lines() const { return frequencies_hz.size(); }
  Eigen::Index num_responses() const {
    return static_cast<Eigen::Index>(responses.size());
  }
  Eigen::Index num_references() const {
    return static_cast<Eigen::Index>(references.size());
  }
  Eigen::Index Pair(Eigen::Index response, Eigen::Index reference) const {
    return response + num_responses() * reference;
  }
};

// Returns the variances of functions relative to each other, from their
// coherence, both lines x pairs: |h|^2 (1 - coherence) / coherence, which is
// that of an H1 estimate but for the number of averages.
Matrix VariancesOfCoherence(const ComplexMatrix& values,
                            const Matrix& coherence);

// Returns "receptance", "mobility" or "accelerance".
const char* FrfQuantityName(int derivative);

// Puts single FRFs together. A place "-name" or "12:-x" measures against its
// direction: the FRF's sign changes and the place loses its sign. Fails, with
// one line that names the file, if FRFs have different lines or quantities, if
// a place is not stated, or if a pair is missing or occurs twice.
[[nodiscard]] bool AssembleFrequencyResponses(
    const std::vector<FrequencyResponse>& single, FrequencyResponses* all,
    std::string* error);

}  // namespace pinode

#endif  // PINODE_RECORD_FRF_FREQUENCY_RESPONSES_H_
