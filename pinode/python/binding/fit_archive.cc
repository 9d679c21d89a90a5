#include "pinode/python/binding/fit_archive.h"

#include <cstdint>
#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "pinode/base/fnv.h"
#include "pinode/problem/result_fields.h"
#include "pinode/report/report.h"

namespace pinode::python {
namespace {

// Packs or unpacks by one visit of the fields. Structured bindings name each
// field, so that a field added elsewhere is a compiler error here.
class Packer {
 public:
  static constexpr bool kReads = false;

  void Bytes(const void* data, size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }
  bool ok() const { return true; }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class Unpacker {
 public:
  static constexpr bool kReads = true;
  explicit Unpacker(const std::string& bytes) : bytes_(bytes) {}

  void Bytes(void* data, size_t size) {
    if (size > bytes_.size() - at_) ok_ = false;
    if (!ok_) return;
    std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }
  // Checks the remaining size, so that a wrong size does not exhaust the
  // memory.
  bool Has(std::uint64_t count, size_t size) {
    ok_ = ok_ && count <= (bytes_.size() - at_) / size;
    return ok_;
  }
  bool ok() const { return ok_; }
  bool AtEnd() const { return ok_ && at_ == bytes_.size(); }

 private:
  const std::string& bytes_;
  size_t at_ = 0;
  bool ok_ = true;
};

template <typename Archive, typename... Fields>
void Visit(Archive* a, Fields&... fields);

template <typename Archive, typename T>
std::enable_if_t<std::is_arithmetic_v<T> || std::is_enum_v<T>> VisitOne(
    Archive* a, T& value) {
  a->Bytes(&value, sizeof(value));
}

// Visits a size, which comes first. A reader's container gets this size, unless
// fewer data remain.
template <typename Archive>
std::uint64_t VisitSize(Archive* a, std::uint64_t size, size_t least) {
  a->Bytes(&size, sizeof(size));
  if constexpr (Archive::kReads) {
    if (!a->Has(size, least)) return 0;
  }
  return size;
}

template <typename Archive>
void VisitOne(Archive* a, std::string& value) {
  value.resize(VisitSize(a, value.size(), 1));
  a->Bytes(value.data(), value.size());
}

template <typename Archive>
void VisitOne(Archive* a, Vector& value) {
  value.resize(static_cast<Eigen::Index>(
      VisitSize(a, static_cast<std::uint64_t>(value.size()), sizeof(double))));
  a->Bytes(value.data(), sizeof(double) * static_cast<size_t>(value.size()));
}

template <typename Archive>
void VisitOne(Archive* a, Matrix& value) {
  std::uint64_t rows = static_cast<std::uint64_t>(value.rows());
  const std::uint64_t size =
      VisitSize(a, static_cast<std::uint64_t>(value.size()), sizeof(double));
  a->Bytes(&rows, sizeof(rows));
  if constexpr (Archive::kReads) {
    if (!a->ok() || (rows == 0 ? size != 0 : size % rows != 0)) return;
    value.resize(static_cast<Eigen::Index>(rows),
                 static_cast<Eigen::Index>(rows == 0 ? 0 : size / rows));
  }
  a->Bytes(value.data(), sizeof(double) * size);
}

template <typename Archive, typename T>
void VisitOne(Archive* a, std::vector<T>& values) {
  values.resize(VisitSize(a, values.size(), 1));
  for (T& value : values) VisitOne(a, value);
}

// Structs with a table of their fields.
template <typename Archive, typename T>
std::enable_if_t<FieldTable<T>::kExists> VisitOne(Archive* a, T& value) {
  VisitFields(value, [a](const char*, auto& field) { VisitOne(a, field); });
}

template <typename Archive>
void VisitOne(Archive* a, Verdict& value) {
  std::vector<Finding> findings = value.findings();
  VisitOne(a, findings);
  if constexpr (Archive::kReads) value = Verdict(std::move(findings));
}

template <typename Archive>
void VisitOne(Archive* a, IdentificationSummary& value) {
  VisitOne(a, static_cast<FitSummary&>(value));
  Visit(a, value.verdict, value.explanations, value.choice, value.profiles,
        value.profile_seconds);
}

template <typename Archive>
void VisitOne(Archive* a, std::vector<bool>& values) {
  values.resize(VisitSize(a, values.size(), 1));
  for (size_t i = 0; i < values.size(); ++i) {
    bool value = values[i];
    a->Bytes(&value, sizeof(value));
    values[i] = value;
  }
}

template <typename Archive>
void VisitOne(Archive* a, ChangeOptions& value) {
  auto& [threshold, rate, draws, absolute, rival_loss] = value;
  Visit(a, threshold, rate, draws, absolute, rival_loss);
}

template <typename Archive>
void VisitOne(Archive* a, ChangeSubject& value) {
  auto& [name, kind, place, dof, force_share] = value;
  Visit(a, name, kind, place, dof, force_share);
}

template <typename Archive>
void VisitOne(Archive* a, GroupChange& value) {
  auto& [change, sigma, lower, upper, probability, changed, p_value] = value;
  Visit(a, change, sigma, lower, upper, probability, changed, p_value);
}

template <typename Archive>
void VisitOne(Archive* a, RivalChange& value) {
  auto& [found, other, loss] = value;
  Visit(a, found, other, loss);
}

template <typename Archive>
void VisitOne(Archive* a, ChangeExplanation& value) {
  auto& [changed, changes, log_odds, probability] = value;
  Visit(a, changed, changes, log_odds, probability);
}

template <typename Archive>
void VisitOne(Archive* a, ChangeEstimate& value) {
  auto& [groups, rivals, between, has_between, chi2, degrees, explanations] =
      value;
  Visit(a, groups, rivals, between, has_between, chi2, degrees, explanations);
}

template <typename Archive>
void VisitOne(Archive* a, Judgement& value) {
  auto& [verdict, reasons, sentence] = value;
  Visit(a, verdict, reasons, sentence);
}

template <typename Archive>
void VisitOne(Archive* a, ChangeCandidate& value) {
  auto& [subject, unit, masses, damping, from, to, basis, library] = value;
  Visit(a, subject, unit, masses, damping, from, to, basis, library);
}

// Visits all fields but the fit, which is that of the whole.
template <typename Archive>
void VisitOne(Archive* a, DamageResult& value) {
  auto& [baselines, options, subjects, estimate, judgement, places, remarks,
         added, problem, summary, model] = value;
  Visit(a, baselines, options, subjects, estimate, judgement, places, remarks,
        added);
}

template <typename Archive>
void VisitOne(Archive* a, Feature& value) {
  auto& [kind, from, to, input] = value;
  Visit(a, kind, from, to, input);
}

template <typename Archive>
void VisitOne(Archive* a, DiscoveredTerm& value) {
  auto& [basis, coefficient, share, rms, inclusion, probability, given, sign,
         unit, regressed, sigma, lower, upper] = value;
  Visit(a, basis, coefficient, share, rms, inclusion, probability, given, sign,
        unit, regressed, sigma, lower, upper);
}

template <typename Archive>
void VisitOne(Archive* a, DiscoveryCandidate& value) {
  auto& [basis, rms, sign, degree, probability] = value;
  Visit(a, basis, rms, sign, degree, probability);
}

template <typename Archive>
void VisitOne(Archive* a, TermRival& value) {
  auto& [without, with, log_odds, fitted] = value;
  Visit(a, without, with, log_odds, fitted);
}

template <typename Archive>
void VisitOne(Archive* a, DiscoveryParetoPoint& value) {
  auto& [terms, residual, bic] = value;
  Visit(a, terms, residual, bic);
}

template <typename Archive>
void VisitOne(Archive* a, DiscoveredEquation& value) {
  auto& [source, network, output, acts_as, features, names, terms, scale, rms,
         residual, uncertainty, num_candidates, candidates, pareto,
         num_regressed, sample_features, sample_outputs] = value;
  Visit(a, source, network, output, acts_as, features, names, terms, scale, rms,
        residual, uncertainty, num_candidates, candidates, pareto,
        num_regressed, sample_features, sample_outputs);
}

// Visits all fields but the fit, as above.
template <typename Archive>
void VisitOne(Archive* a, Discovery& value) {
  auto& [equations, dropped, added, rivals, refitted, problem, summary, model,
         refinement] = value;
  Visit(a, equations, dropped, added, rivals, refitted, refinement);
}

// Visits an optional part. The fit to which it belongs is set in it.
template <typename Archive, typename T>
void VisitPart(Archive* a, const Fit& fit, std::shared_ptr<const T>* part) {
  bool there = *part != nullptr;
  VisitOne(a, there);
  if (!there) return;
  T value;
  if constexpr (!Archive::kReads) value = **part;
  VisitOne(a, value);
  if constexpr (Archive::kReads) {
    value.problem = fit.c.problem;
    value.summary = fit.summary;
    value.model = fit.model;
    *part = std::make_shared<const T>(std::move(value));
  }
}

template <typename Archive, typename... Fields>
void Visit(Archive* a, Fields&... fields) {
  (VisitOne(a, fields), ...);
}

// Number of the layout of a packed fit. Count it up when a visited struct
// changes.
constexpr int kLayout = 7;

// Integration steps of a record, which a fit may have refined.
struct RecordSteps {
  int substeps = 0;
  bool chosen = false;
  int exponential_steps = 0;
  int integrator = -1;  // -1: not given
};

template <typename Archive>
void VisitOne(Archive* a, RecordSteps& value) {
  auto& [substeps, chosen, exponential_steps, integrator] = value;
  Visit(a, substeps, chosen, exponential_steps, integrator);
}

template <typename Archive>
void VisitFit(Archive* a, int* layout, std::string* version,
              std::vector<RecordSteps>* steps, Fit* fit) {
  Visit(a, *layout, *version, *steps, fit->c.problem.description.remarks,
        fit->summary, fit->model, fit->seconds, fit->troubles);
}

void SetSteps(const std::vector<RecordSteps>& steps,
              IdentificationProblem* problem) {
  for (size_t r = 0; r < steps.size(); ++r) {
    IdentificationRecord& record = problem->records[r];
    record.substeps = steps[r].substeps;
    record.substeps_chosen = steps[r].chosen;
    record.exponential_steps = steps[r].exponential_steps;
    record.integrator.reset();
    if (steps[r].integrator >= 0) {
      record.integrator = static_cast<Integrator>(steps[r].integrator);
    }
  }
}

}  // namespace

std::string PackFit(const Fit& fit) {
  int layout = kLayout;
  std::string version = PinodeVersion();
  std::vector<RecordSteps> steps;
  for (const IdentificationRecord& record : fit.c.problem.records) {
    steps.push_back(
        {record.substeps, record.substeps_chosen, record.exponential_steps,
         record.integrator.has_value() ? static_cast<int>(*record.integrator)
                                       : -1});
  }
  Fit copy = fit;
  Packer packer;
  VisitFit(&packer, &layout, &version, &steps, &copy);
  VisitPart(&packer, fit, &copy.damage);
  VisitPart(&packer, fit, &copy.discovery);
  std::string bytes = packer.Take();
  // The checksum rejects data that were cut off or mixed up.
  const std::uint64_t sum = Fnv1a(bytes.data(), bytes.size());
  bytes.append(reinterpret_cast<const char*>(&sum), sizeof(sum));
  return bytes;
}

bool UnpackFit(const std::string& packed, Fit* fit) {
  std::uint64_t sum = 0;
  if (packed.size() < sizeof(sum)) return false;
  const std::string bytes = packed.substr(0, packed.size() - sizeof(sum));
  std::memcpy(&sum, packed.data() + bytes.size(), sizeof(sum));
  if (sum != Fnv1a(bytes.data(), bytes.size())) return false;
  Unpacker unpacker(bytes);
  int layout = 0;
  std::string version;
  std::vector<RecordSteps> steps;
  Fit result;
  result.c = fit->c;
  VisitFit(&unpacker, &layout, &version, &steps, &result);
  if (!unpacker.ok() || layout != kLayout || version != PinodeVersion() ||
      steps.size() != result.c.problem.records.size()) {
    return false;
  }
  SetSteps(steps, &result.c.problem);
  VisitPart(&unpacker, result, &result.damage);
  VisitPart(&unpacker, result, &result.discovery);
  if (!unpacker.AtEnd()) return false;
  *fit = std::move(result);
  return true;
}

}  // namespace pinode::python
