#include "bench/published.h"

#include "util/data_path.h"
#include "util/options.h"

namespace msf {

StatusOr<PublishedFigures> LoadPublishedFigures() {
  const StatusOr<std::filesystem::path> file = FindDataFile("suites/published/figures.yaml");
  if (!file.ok()) return file.status();
  PublishedFigures figures;
  const Status status = LoadOptions(*file, figures);
  if (!status.ok()) return status;
  return figures;
}

}  // namespace msf
