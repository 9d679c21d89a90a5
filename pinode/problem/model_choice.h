// Which of a problem's candidate terms stayed, and why.

#ifndef PINODE_PROBLEM_MODEL_CHOICE_H_
#define PINODE_PROBLEM_MODEL_CHOICE_H_

#include <string>
#include <vector>

namespace pinode {

struct ModelChoice {
  // One fit that was compared with the one before it.
  struct Step {
    // The candidates that it left out and those that it took in again.
    std::vector<std::string> left_out;
    std::vector<std::string> taken_in;
    // The other terms could be fitted, and the criterion became smaller.
    bool fitted = false;
    bool accepted = false;
    // Changes of the deviance, divided by `memory`, and of the prices; negative
    // ones are gains.
    double deviance = 0.0;
    double price = 0.0;

    double criterion() const { return deviance + price; }
  };

  // Names, in the problem's order.
  std::vector<std::string> candidates;
  std::vector<std::string> left_out;
  // The unknowns that went with them.
  std::vector<std::string> left_out_parameters;
  // By how much the residuals of the fit with all candidates are fewer than
  // they look, see FittedCost.
  double memory = 1.0;
  std::vector<Step> steps;
  bool complete = false;  // false: cut off

  bool empty() const { return candidates.empty(); }

  // "Model choice: 3 candidates, 1 kept (oil); ..." with the criterion of each
  // step.
  std::string Sentence() const;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_MODEL_CHOICE_H_
