// Choice among a problem's candidate terms, with the reasons.

#ifndef PINODE_PROBLEM_MODEL_CHOICE_H_
#define PINODE_PROBLEM_MODEL_CHOICE_H_

#include <string>
#include <vector>

namespace pinode {

struct ModelChoice {
  // One fit that was compared with the one before it.
  struct Step {
    // Candidates that the fit left out, and those that it took in again.
    std::vector<std::string> left_out;
    std::vector<std::string> taken_in;
    // True if the other terms could be fitted and the criterion became smaller.
    bool fitted = false;
    bool accepted = false;
    // Changes of the deviance, divided by `memory`, and of the price of the
    // unknowns; negative values are gains.
    double deviance = 0.0;
    double price = 0.0;

    double criterion() const { return deviance + price; }
  };

  // Names of the candidate terms, in the problem's order.
  std::vector<std::string> candidates;
  std::vector<std::string> left_out;
  // Unknowns that were left out with them.
  std::vector<std::string> left_out_parameters;
  // Factor between the number of residuals and their effective number in the
  // fit with all candidates, see FittedCost.
  double memory = 1.0;
  std::vector<Step> steps;
  bool complete = false;  // false: cut off

  bool empty() const { return candidates.empty(); }

  // Returns "Model choice: 3 candidates, 1 kept (oil); ..." with the criterion
  // of each step.
  std::string Sentence() const;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_MODEL_CHOICE_H_
