// The lowest modes of a model in a NumPy archive with M and K, their CPU time,
// residual and memory; tests/benchmarks/sparse_modes.py makes the model and
// holds SciPy against it.
//
//   pinode_sparse_modes MODEL.npz MODES

#include "pinode/structure/sparse/sparse_modes.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

#include "pinode/structure/decks/finite_element_files.h"

int main(int argc, char** argv) {
  using namespace pinode;
  if (argc != 3 || std::atoi(argv[2]) < 1) {
    std::fprintf(stderr, "usage: %s MODEL.npz MODES\n", argv[0]);
    return 2;
  }
  FiniteElementFiles files;
  files.mass.path = files.stiffness.path = argv[1];
  FiniteElementModel model;
  SparseModes modes;
  std::string error;
  if (!ReadFiniteElementModel(files, &model, &error)) {
    std::fprintf(stderr, "%s\n", error.c_str());
    return 2;
  }
  const std::clock_t begin = std::clock();
  if (!ComputeLowestModes(model.mass, model.stiffness, std::atoi(argv[2]),
                          &modes, &error)) {
    std::fprintf(stderr, "%s\n", error.c_str());
    return 1;
  }
  const double seconds =
      static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  double residual = 0.0;
  for (Eigen::Index i = 0; i < modes.eigenvalues.size(); ++i) {
    const Vector elastic = model.stiffness * modes.mode_shapes.col(i);
    const Vector inertial =
        modes.eigenvalues[i] * (model.mass * modes.mode_shapes.col(i));
    residual = std::max(residual, (elastic - inertial).norm() / elastic.norm());
  }
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  std::printf("dofs %d\nseconds %.2f\nresidual %.3g\ngibibytes %.3f\n",
              model.num_dofs(), seconds, residual,
              static_cast<double>(usage.ru_maxrss) / 1048576.0);
  for (const double value : modes.eigenvalues) {
    std::printf("eigenvalue %.17g\n", value);
  }
  return 0;
}
