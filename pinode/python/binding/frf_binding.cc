#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <complex>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pinode/base/file.h"
#include "pinode/case/sections/modes_frf_section.h"
#include "pinode/python/binding/convert.h"
#include "pinode/python/binding/fit.h"
#include "pinode/record/frf/frf_estimate.h"
#include "pinode/record/frf/frf_files.h"

namespace pinode::python {
namespace {

namespace py = pybind11;

struct FrfHandle {
  FrfEstimate estimate;
  FrequencyResponses all;
};

// Estimates FRFs of records, each a pair of forces and responses, samples x
// channels. Lengths of blocks and windows are in s; 0: not given.
std::shared_ptr<FrfHandle> EstimateFromArrays(
    const py::list& records, double step,
    const std::vector<std::string>& responses,
    const std::vector<std::string>& references, int derivative,
    const std::string& estimator, const std::string& excitation, double block,
    double overlap, double force_window, double exponential_window) {
  std::vector<ForcedRecord> all;
  for (const py::handle& record : records) {
    const auto parts = Cast<py::tuple>(record, "a record", "a tuple");
    if (parts.size() != 2) throw Error("a record has forces and responses");
    ForcedRecord one;
    one.name = std::to_string(all.size() + 1);
    one.sampling_step = step;
    one.forces = ToMatrix(parts[0], "force").transpose();
    one.responses = ToMatrix(parts[1], "responses").transpose();
    if (one.forces.rows() != static_cast<Eigen::Index>(references.size()) ||
        one.responses.rows() != static_cast<Eigen::Index>(responses.size())) {
      throw Error("record " + one.name + " has " +
                  std::to_string(one.forces.rows()) + " forces and " +
                  std::to_string(one.responses.rows()) +
                  " responses, expected a name for each");
    }
    all.push_back(std::move(one));
  }
  FrfEstimateOptions options;
  if (!ParseFrfEstimator(estimator, &options.estimator)) {
    throw Error("estimator is '" + estimator + "', expected h1, h2 or hv");
  }
  if (!ParseFrfExcitation(excitation, &options.excitation)) {
    throw Error("excitation is '" + excitation +
                "', expected automatic, blows, random or periodic");
  }
  options.overlap = overlap;
  options.force_window = force_window;
  options.exponential_window = exponential_window;
  auto handle = std::make_shared<FrfHandle>();
  std::string error;
  bool ok = false;
  {
    py::gil_scoped_release release;
    ok = (block == 0.0 || all.empty() ||
          FindFrfBlock(all, block, &options, &error)) &&
         EstimateFrfs(all, options, &handle->estimate, &error) &&
         AssembleFrequencyResponses(
             SingleFrfs(handle->estimate, "record", responses, references,
                        derivative),
             &handle->all, &error);
  }
  Require(ok, error);
  return handle;
}

// Returns lines x responses x references.
template <typename Scalar>
py::array_t<Scalar> ByPlaces(
    const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>& values,
    const FrequencyResponses& all) {
  const std::vector<Eigen::Index> shape = {values.rows(), all.num_responses(),
                                           all.num_references()};
  py::array_t<Scalar> result(shape);
  auto view = result.template mutable_unchecked<3>();
  for (Eigen::Index k = 0; k < shape[0]; ++k) {
    for (Eigen::Index o = 0; o < shape[1]; ++o) {
      for (Eigen::Index j = 0; j < shape[2]; ++j) {
        view(k, o, j) = values(k, all.Pair(o, j));
      }
    }
  }
  return result;
}

void SaveFrfs(const FrfHandle& handle, const std::string& path) {
  FrequencyResponses all = handle.all;
  if (handle.estimate.num_averages < kFewestAveragesForWeights) {
    all.coherence.resize(0, 0);
  }
  std::string error;
  Require(WriteFileAtomically(path, FormatFrfFile(all, "", ""), &error), error);
}

}  // namespace

void BindFrfs(py::module_* module) {
  py::class_<FrfHandle, std::shared_ptr<FrfHandle>>(*module, "FrfHandle")
      .def("save", &SaveFrfs, py::arg("path"))
      .def_property_readonly("responses",
                             [](const FrfHandle& h) { return h.all.responses; })
      .def_property_readonly(
          "references", [](const FrfHandle& h) { return h.all.references; })
      .def_property_readonly(
          "frequencies_hz",
          [](const FrfHandle& h) { return FromVector(h.all.frequencies_hz); })
      .def_property_readonly("values",
                             [](const FrfHandle& h) {
                               return ByPlaces<std::complex<double>>(
                                   h.all.values, h.all);
                             })
      .def_property_readonly("coherence",
                             [](const FrfHandle& h) {
                               return ByPlaces<double>(h.all.coherence, h.all);
                             })
      .def_property_readonly("variances",
                             [](const FrfHandle& h) {
                               return ByPlaces<double>(h.estimate.variances,
                                                       h.all);
                             })
      .def_property_readonly(
          "num_blocks",
          [](const FrfHandle& h) { return h.estimate.num_blocks; })
      .def_property_readonly(
          "num_averages",
          [](const FrfHandle& h) { return h.estimate.num_averages; })
      .def_property_readonly(
          "decay_rate", [](const FrfHandle& h) { return h.all.decay_rate; })
      .def_property_readonly(
          "remarks", [](const FrfHandle& h) { return h.estimate.remarks; });
  module->def("estimate_frfs", &EstimateFromArrays, py::arg("records"),
              py::arg("step"), py::arg("responses"), py::arg("references"),
              py::arg("derivative"), py::arg("estimator"),
              py::arg("excitation"), py::arg("block"), py::arg("overlap"),
              py::arg("force_window"), py::arg("exponential_window"));
}

}  // namespace pinode::python
