#include "pinode/case/results/discover_files.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "pinode/base/file.h"
#include "pinode/base/strings.h"
#include "pinode/case/results/verdict_json.h"

namespace pinode {
namespace {

using Json = nlohmann::ordered_json;

Json Number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::string Upright(const std::string& name) {
  std::string text = "{\\mathrm{";
  for (const char c : name) {
    if (std::string("_%&#$").find(c) != std::string::npos) text += '\\';
    text += c;
  }
  return text + "}}";
}

// Returns `inner`, the text in the brackets of feature `head`, as LaTeX.
std::string FeatureAsLatex(const std::string& head, const std::string& inner) {
  if (head == "x") return "x_" + Upright(inner);
  if (head == "v") return "\\dot{x}_" + Upright(inner);
  if (head == "input") return "u_" + Upright(inner);
  const size_t comma = inner.find(',');
  const std::string first = inner.substr(0, comma);
  const std::string second =
      comma == std::string::npos ? "" : inner.substr(comma + 1);
  const std::string letter = head == "w" ? "\\dot{x}_" : "x_";
  if (second == "ground") return "(-" + letter + Upright(first) + ")";
  if (first == "ground") return letter + Upright(second);
  return "(" + letter + Upright(second) + " - " + letter + Upright(first) + ")";
}

// Returns a coefficient with as many digits as its interval justifies, at least
// four.
std::string Digits(const DiscoveredTerm& term) {
  int digits = 6;
  if (term.sigma > 0.0 && term.coefficient != 0.0) {
    const double ratio = std::abs(term.coefficient) / term.sigma;
    digits = 2 + static_cast<int>(std::floor(std::log10(std::max(ratio, 1.0))));
    digits = std::max(4, std::min(digits, 12));
  }
  return FormatNumber(term.coefficient, digits);
}

// "without u1: x[u1]^3; with u1: x[u1]*v[u1]^2".
std::string RivalAsText(const TermRival& rival) {
  std::string text;
  if (!rival.without.empty()) text += "without " + Join(rival.without, ", ");
  if (!rival.with.empty()) {
    text += std::string(text.empty() ? "" : "; ") + "with " +
            Join(rival.with, ", ");
  }
  return text;
}

// "odds 0.35". Large odds have too many digits, or are infinite.
std::string OddsAsText(double log_odds) {
  const double odds = std::exp(log_odds);
  return odds > 99.0 ? "log odds " + FormatNumber(log_odds, 3)
                     : "odds " + FormatNumber(odds, 2);
}

constexpr char kCheckpointSchema[] = "pinode-discover-checkpoint-1";

// Finds the term `basis` of an equation as regressed or as a candidate; false
// if it is neither.
bool FindTerm(const DiscoveredEquation& equation, const std::string& basis,
              DiscoveredTerm* term) {
  for (const DiscoveredTerm& regressed : equation.terms) {
    if (regressed.basis != basis) continue;
    *term = regressed;
    return true;
  }
  for (const DiscoveryCandidate& candidate : equation.candidates) {
    if (candidate.basis != basis) continue;
    *term = DiscoveredTerm();
    term->basis = basis;
    term->basis_rms = candidate.rms;
    term->sign = candidate.sign;
    term->inclusion_probability = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  return false;
}

// Returns "2\times 10^{-3}" for "2e-3".
std::string NumberAsLatex(const std::string& number) {
  const size_t e = number.find('e');
  if (e == std::string::npos) return number;
  return number.substr(0, e) + "\\times 10^{" +
         std::to_string(std::stoi(number.substr(e + 1))) + "}";
}

}  // namespace

std::string BasisAsLatex(const std::string& basis) {
  std::string text;
  for (size_t i = 0; i < basis.size();) {
    const char c = basis[i];
    if (std::isalpha(static_cast<unsigned char>(c))) {
      size_t end = i;
      while (end < basis.size() &&
             std::isalnum(static_cast<unsigned char>(basis[end]))) {
        ++end;
      }
      const std::string word = basis.substr(i, end - i);
      if (end < basis.size() && basis[end] == '[') {
        const size_t close = basis.find(']', end);
        text += FeatureAsLatex(word, basis.substr(end + 1, close - end - 1));
        i = close + 1;
      } else {
        text += end < basis.size() && basis[end] == '('
                    ? "\\operatorname{" + word + "}"
                : word == "pi" ? "\\pi"
                               : word;
        i = end;
      }
    } else if (c == '*') {
      text += "\\,";
      ++i;
    } else if (c == '^') {
      // Exponent: a plain number, or the text in brackets.
      size_t end = i + 1;
      if (end < basis.size() && basis[end] == '(') {
        int depth = 0;
        do {
          depth += basis[end] == '(' ? 1 : basis[end] == ')' ? -1 : 0;
          ++end;
        } while (end < basis.size() && depth > 0);
        text += "^{" + BasisAsLatex(basis.substr(i + 2, end - i - 3)) + "}";
      } else {
        while (end < basis.size() &&
               (std::isdigit(static_cast<unsigned char>(basis[end])) ||
                basis[end] == '.')) {
          ++end;
        }
        if (end == i + 1) {
          text += "^";
        } else {
          text += "^{" + basis.substr(i + 1, end - i - 1) + "}";
        }
      }
      i = end;
    } else {
      text += c;
      ++i;
    }
  }
  return text;
}

std::string EquationsAsText(const Discovery& discovery) {
  std::string text =
      "These equations replace the networks. Accelerations are added to dv/dt. "
      "Forces are\nsubtracted from the right-hand side of M a + C v + K x = "
      "B u.\n";
  if (!discovery.refitted) {
    text +=
        "The coefficients come from the regression. They were not refitted to "
        "the simulation.\n";
  }
  for (size_t e = 0; e < discovery.equations.size(); ++e) {
    const DiscoveredEquation& equation = discovery.equations[e];
    text += std::string("\n") +
            (equation.acts_as == ActsAs::kForce ? "force" : "acceleration") +
            " at " + equation.output + ", for network " + equation.network +
            " =\n";
    if (equation.terms.empty()) text += "    0\n";
    for (const DiscoveredTerm& term : equation.terms) {
      text += "    " + std::string(term.coefficient < 0.0 ? "" : "+") +
              Digits(term) + " * " + term.basis;
      if (std::isfinite(term.lower95) && std::isfinite(term.upper95)) {
        text += "    95 %: +- " +
                FormatNumber(0.5 * (term.upper95 - term.lower95), 3);
      }
      text += "    unit " + term.unit + ", regressed " +
              FormatNumber(term.regressed, 5);
      if (term.probability < kCertainTerm) {
        text += ", uncertain: probability " +
                std::to_string(std::lround(100.0 * term.probability)) + " %";
      }
      text += "\n";
    }
  }
  // Rivals of terms that are certain are in discover.json only.
  constexpr double kSmallestOdds = 1.0 / 19.0;
  constexpr int kMostRivals = 5;
  int count = 0;
  for (const TermRival& rival : discovery.rivals) {
    const double odds = std::exp(rival.log_odds);
    if (odds < kSmallestOdds || count == kMostRivals) break;
    if (count == 0) {
      text += "\nOther terms describe the records as well or nearly as well:\n";
    }
    ++count;
    text +=
        "    " + OddsAsText(rival.log_odds) + ": " + RivalAsText(rival) + "\n";
  }
  return text;
}

std::string EquationsAsLatex(const Discovery& discovery) {
  std::string text = "\\begin{align}\n";
  for (size_t e = 0; e < discovery.equations.size(); ++e) {
    const DiscoveredEquation& equation = discovery.equations[e];
    text += std::string(equation.acts_as == ActsAs::kForce ? "  f" : "  g") +
            "_" + Upright(equation.output) + " &= ";
    bool first = true;
    for (const DiscoveredTerm& term : equation.terms) {
      std::string number = Digits(term);
      const bool negative = number[0] == '-';
      if (negative) number.erase(0, 1);
      text += first ? (negative ? "-" : "") : (negative ? " - " : " + ");
      text += NumberAsLatex(number) + "\\," + BasisAsLatex(term.basis);
      first = false;
    }
    if (first) text += "0";
    text += e + 1 < discovery.equations.size() ? " \\\\\n" : "\n";
  }
  return text + "\\end{align}\n";
}

std::string DiscoveryAsJson(const Discovery& discovery) {
  Json json;
  json["schema"] = "pinode-discover-1";
  json["refitted"] = discovery.refitted;
  WriteVerdict(discovery.verdict(), &json);
  json["message"] = discovery.Message();
  json["step_refinement"] = discovery.step_refinement;
  json["dropped"] = discovery.dropped;
  json["added"] = discovery.added;
  json["rivals"] = Json::array();
  for (const TermRival& rival : discovery.rivals) {
    json["rivals"].push_back({{"without", rival.without},
                              {"with", rival.with},
                              {"log_odds", Number(rival.log_odds)},
                              {"fitted", rival.fitted}});
  }
  json["equations"] = Json::array();
  for (size_t e = 0; e < discovery.equations.size(); ++e) {
    const DiscoveredEquation& equation = discovery.equations[e];
    Json entry;
    entry["output"] = equation.output;
    entry["network"] = equation.network;
    entry["acts_as"] =
        equation.acts_as == ActsAs::kForce ? "force" : "acceleration";
    entry["output_rms"] = Number(equation.output_rms);
    entry["residual"] = Number(equation.residual);
    entry["uncertainty"] = Number(equation.uncertainty);
    entry["candidates"] = equation.num_candidates;
    entry["terms"] = Json::array();
    for (const DiscoveredTerm& term : equation.terms) {
      entry["terms"].push_back(
          {{"basis", term.basis},
           {"coefficient", Number(term.coefficient)},
           {"lower95", Number(term.lower95)},
           {"upper95", Number(term.upper95)},
           {"sigma", Number(term.sigma)},
           {"unit", term.unit},
           {"from_network", Number(term.regressed)},
           {"share", Number(term.share)},
           {"probability", Number(term.probability)},
           {"inclusion_probability", Number(term.inclusion_probability)}});
    }
    entry["pareto"] = Json::array();
    for (const DiscoveryParetoPoint& point : equation.pareto) {
      entry["pareto"].push_back({{"terms", point.num_terms},
                                 {"residual", Number(point.residual)},
                                 {"bic", Number(point.bic)}});
    }
    json["equations"].push_back(std::move(entry));
  }
  // Names of DOFs that are not UTF-8 must not end the program.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

bool WriteDiscoverFiles(const Discovery& discovery, const std::string& folder,
                        std::string* error) {
  return WriteFileAtomically(folder + "/discover.json",
                             DiscoveryAsJson(discovery), error) &&
         WriteFileAtomically(folder + "/equations.txt",
                             EquationsAsText(discovery), error) &&
         WriteFileAtomically(folder + "/equations.tex",
                             EquationsAsLatex(discovery), error);
}

bool WriteDiscoverCheckpoint(const std::string& path,
                             const std::string& problem_hash,
                             const std::vector<DiscoveredEquation>& equations,
                             std::string* error) {
  Json json;
  json["schema"] = kCheckpointSchema;
  json["problem"] = problem_hash;
  json["equations"] = Json::array();
  for (const DiscoveredEquation& equation : equations) {
    Json entry;
    entry["network"] = equation.network;
    entry["output"] = equation.output;
    entry["terms"] = Json::array();
    for (const DiscoveredTerm& term : equation.terms) {
      entry["terms"].push_back(
          {{"basis", term.basis}, {"coefficient", Number(term.coefficient)}});
    }
    json["equations"].push_back(std::move(entry));
  }
  return WriteFileAtomically(
      path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n",
      error);
}

bool ReadDiscoverCheckpoint(const std::string& path,
                            const std::string& problem_hash,
                            const std::vector<DiscoveredEquation>& regressed,
                            std::vector<DiscoveredEquation>* resumed,
                            std::string* error) {
  std::string text;
  if (!ReadTextFile(path, &text, error)) return false;
  const auto fail = [&](const std::string& message) {
    *error = path + ": " + message;
    return false;
  };
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("schema")) {
    return fail("is not a checkpoint of pinode_discover");
  }
  if (json["schema"] == "pinode-checkpoint-1") {
    return fail(
        "the refit there is complete, expected an interrupted one; give "
        "--overwrite to replace it");
  }
  if (json["schema"] != kCheckpointSchema || !json.contains("problem") ||
      !json.contains("equations") || !json["equations"].is_array()) {
    return fail("is not a checkpoint of pinode_discover");
  }
  if (json["problem"] != problem_hash) {
    return fail(
        "belongs to another case: model, unknowns or records have changed");
  }
  if (json["equations"].size() != regressed.size()) {
    return fail("its equations are not those of the section [discover]");
  }
  std::vector<DiscoveredEquation> result = regressed;
  for (size_t e = 0; e < result.size(); ++e) {
    const Json& entry = json["equations"][e];
    if (!entry.is_object() || !entry.contains("output") ||
        !entry.contains("network") || entry["output"] != result[e].output ||
        entry["network"] != result[e].network || !entry.contains("terms") ||
        !entry["terms"].is_array()) {
      return fail("its equations are not those of the section [discover]");
    }
    std::vector<DiscoveredTerm> terms;
    for (const Json& term : entry["terms"]) {
      DiscoveredTerm found;
      if (!term.is_object() || !term.contains("basis") ||
          !term["basis"].is_string() || !term.contains("coefficient") ||
          !term["coefficient"].is_number() ||
          !FindTerm(result[e], term["basis"].get<std::string>(), &found)) {
        return fail(
            "output '" + result[e].output +
            "' has a term that is not a candidate of the section [discover]");
      }
      found.coefficient = term["coefficient"].get<double>();
      found.share =
          std::abs(found.coefficient) * found.basis_rms / result[e].scale;
      terms.push_back(std::move(found));
    }
    result[e].terms = std::move(terms);
  }
  *resumed = std::move(result);
  return true;
}

}  // namespace pinode
