// Images with labelled boxes in the layout of the PASCAL VOC challenges:
// ROOT/Annotations/ID.xml, ROOT/JPEGImages/ID.jpg, ROOT/ImageSets/Main/SET.txt.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "util/status.h"

namespace msf {

// A labelled object; the box spans [x0, x1) x [y0, y1) in pixels of the image.
struct VocObject {
  int label = 0;  // index into the class names
  float x0 = 0.0F;
  float y0 = 0.0F;
  float x1 = 0.0F;
  float y1 = 0.0F;
  bool difficult = false;
};

struct VocImage {
  std::string id;
  std::filesystem::path file;
  int width = 0;
  int height = 0;
  std::vector<VocObject> objects;
};

// One annotation document; `origin` names it in errors. VOC counts pixels from 1 and includes the
// last one, so xmin = 1, xmax = 10 become [0, 10). Objects of a class that is not among `classes`,
// boxes that leave the image or are empty are errors.
StatusOr<VocImage> ParseVocAnnotation(const std::string& xml, const std::string& origin,
                                      const std::vector<std::string>& classes);

// All images of ROOT/ImageSets/Main/SET.txt with their annotations, in the order of the list.
// `root_and_set` is "ROOT" (its trainval set) or "ROOT:SET". A missing file, an empty set or a
// wrong annotation is an error that names it.
StatusOr<std::vector<VocImage>> LoadVocSet(const std::string& root_and_set,
                                           const std::vector<std::string>& classes);

}  // namespace msf
