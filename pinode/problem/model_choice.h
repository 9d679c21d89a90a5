// Choice among the candidate terms of a problem, with the fits that led to it.

#ifndef PINODE_PROBLEM_MODEL_CHOICE_H_
#define PINODE_PROBLEM_MODEL_CHOICE_H_

#include <string>
#include <vector>

namespace pinode {

// Result of the choice, see pinode/study/terms/term_choice.h.
struct ModelChoice {
  // One fit, compared with the last accepted one.
  struct Step {
    // Candidates that this fit left out, and candidates that it included again.
    std::vector<std::string> left_out;
    std::vector<std::string> taken_in;
    // fitted: the fit succeeded. accepted: it also made the criterion smaller.
    bool fitted = false;
    bool accepted = false;
    // Changes of the deviance (twice the cost) divided by `memory`, and of the
    // price of the unknowns. The criterion is their sum; negative is better.
    double deviance = 0.0;
    double price = 0.0;

    // Change of the criterion.
    double criterion() const { return deviance + price; }
  };

  // Names of the candidate terms, in the problem's order.
  std::vector<std::string> candidates;
  std::vector<std::string> left_out;
  // Names of the parameters of the terms that were left out.
  std::vector<std::string> left_out_parameters;
  // Number of residuals divided by the number of independent ones, in the fit
  // with all candidates. See FittedCost.
  double memory = 1.0;
  std::vector<Step> steps;
  bool complete = false;  // false: the choice was interrupted

  // True if there were no candidates.
  bool empty() const { return candidates.empty(); }

  // Returns the choice in words, with the criterion of each step: "Model
  // choice: 3 candidates, 1 kept (oil); ...".
  std::string Sentence() const;
};

}  // namespace pinode

#endif  // PINODE_PROBLEM_MODEL_CHOICE_H_
