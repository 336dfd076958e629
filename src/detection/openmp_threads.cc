#include "detection/openmp_threads.h"

#include <omp.h>

namespace msf {

OpenMpThreadsScope::OpenMpThreadsScope(int threads) : before_(omp_get_max_threads()) {
  omp_set_num_threads(threads);
}

OpenMpThreadsScope::~OpenMpThreadsScope() { omp_set_num_threads(before_); }

}  // namespace msf
