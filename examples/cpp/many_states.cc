// Accelerations and joint forces of a closed mechanism at thousands of states: a file is read, decided once, and then
// evaluated four states at a time on two threads. `many_states model.yaml`
#include <cmath>
#include <cstdio>
#include <memory>

#include "ferrers/dynamics/forward_batch.h"
#include "ferrers/dynamics/initial_state.h"
#include "ferrers/io/model_reader.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s model.yaml\n", argv[0]);
    return 2;
  }
  ferrers::ModelReadResult read = ferrers::read_model_file(argv[1]);
  if (!read.model) {
    std::fprintf(stderr, "%s cannot be read; `ferrers analyze` says why\n", argv[1]);
    return 3;
  }
  const auto model = ferrers::make_dynamics_model(ferrers::make_system(std::move(*read.model)));
  const ferrers::InitialStateResult start = ferrers::make_initial_state(*model);
  if (start.status != ferrers::InitialStateStatus::kReady) {
    std::fprintf(stderr, "%s: %s\n", argv[1], start.message.c_str());
    return 4;
  }

  ferrers::ForwardBatch batch(model, start.state, /*threads=*/2);
  ferrers::ForwardBatch::States states;  // one per row: here the same pose, faster and faster
  const long count = 10000;
  states.q = start.state.q.transpose().replicate(count, 1);
  states.v = Eigen::MatrixXd::Zero(count, model->system->nv);
  for (long i = 0; i < count; ++i) states.v.row(i) = start.state.v.transpose() * (static_cast<double>(i) / count);
  ferrers::ForwardBatch::Results results;
  batch.evaluate(states, results);

  std::printf("%s: %d coordinates, %d of %d rows count\n", model->system->model->name().c_str(), model->system->nv,
              static_cast<int>(batch.selection().rows.size()), model->system->m);
  for (const long i : {0L, count / 2}) {
    std::printf("at %.0f %% of its speed: |vdot| = %.9g, |lambda| = %.9g\n", 100.0 * static_cast<double>(i) / count,
                results.vdot.row(i).norm(), results.lambda.row(i).norm());
  }
  return 0;
}
