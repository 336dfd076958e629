#include "io/voc_dataset.h"

#include <algorithm>
#include <fstream>
#include <pugixml.hpp>
#include <sstream>

namespace msf {

namespace {

StatusOr<std::string> ReadText(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    return Status::Error(file.string() +
                         ": cannot be opened; is this a folder in PASCAL VOC layout?");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

StatusOr<VocObject> ParseObject(const pugi::xml_node& node, const VocImage& image,
                                const std::string& origin,
                                const std::vector<std::string>& classes) {
  const std::string name = node.child_value("name");
  const auto found = std::find(classes.begin(), classes.end(), name);
  if (found == classes.end()) {
    return Status::Error(origin + ": class '" + name + "' is none of the model's " +
                         std::to_string(classes.size()) + " classes");
  }
  const pugi::xml_node box = node.child("bndbox");
  VocObject object;
  object.label = static_cast<int>(found - classes.begin());
  object.x0 = box.child("xmin").text().as_float() - 1.0F;
  object.y0 = box.child("ymin").text().as_float() - 1.0F;
  object.x1 = box.child("xmax").text().as_float();
  object.y1 = box.child("ymax").text().as_float();
  object.difficult = node.child("difficult").text().as_int() != 0;
  // One pixel of grace: rescaled annotations round, and some tools count from 0.
  const bool inside = object.x0 >= -1.0F && object.y0 >= -1.0F &&
                      object.x1 <= static_cast<float>(image.width) + 1.0F &&
                      object.y1 <= static_cast<float>(image.height) + 1.0F;
  const bool empty =
      !(std::min(object.x1, static_cast<float>(image.width)) > std::max(object.x0, 0.0F)) ||
      !(std::min(object.y1, static_cast<float>(image.height)) > std::max(object.y0, 0.0F));
  if (!box || !inside || empty) {
    std::ostringstream sentence;
    sentence << origin << ": the box of '" << name << "' (" << object.x0 + 1 << ", "
             << object.y0 + 1 << ")-(" << object.x1 << ", " << object.y1
             << ") is empty or outside the " << image.width << "x" << image.height << " image";
    return Status::Error(sentence.str());
  }
  object.x0 = std::max(object.x0, 0.0F);
  object.y0 = std::max(object.y0, 0.0F);
  object.x1 = std::min(object.x1, static_cast<float>(image.width));
  object.y1 = std::min(object.y1, static_cast<float>(image.height));
  return object;
}

}  // namespace

StatusOr<VocImage> ParseVocAnnotation(const std::string& xml, const std::string& origin,
                                      const std::vector<std::string>& classes) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(xml.data(), xml.size());
  if (!parsed) {
    return Status::Error(origin + ": no XML (" + parsed.description() + " at byte " +
                         std::to_string(parsed.offset) + ")");
  }
  const pugi::xml_node root = document.child("annotation");
  VocImage image;
  image.width = root.child("size").child("width").text().as_int();
  image.height = root.child("size").child("height").text().as_int();
  if (image.width <= 0 || image.height <= 0)
    return Status::Error(origin + ": the annotation gives no image size");
  for (const pugi::xml_node& node : root.children("object")) {
    StatusOr<VocObject> object = ParseObject(node, image, origin, classes);
    if (!object.ok()) return object.status();
    image.objects.push_back(*object);
  }
  return image;
}

StatusOr<std::vector<VocImage>> LoadVocSet(const std::string& root_and_set,
                                           const std::vector<std::string>& classes) {
  const size_t colon = root_and_set.rfind(':');
  const std::filesystem::path root = root_and_set.substr(0, colon);
  const std::string set = colon == std::string::npos ? "trainval" : root_and_set.substr(colon + 1);
  const std::filesystem::path list_file = root / "ImageSets" / "Main" / (set + ".txt");
  const StatusOr<std::string> list = ReadText(list_file);
  if (!list.ok()) return list.status();

  std::vector<VocImage> images;
  std::istringstream ids(*list);
  for (std::string id; ids >> id;) {
    const std::filesystem::path annotation = root / "Annotations" / (id + ".xml");
    const StatusOr<std::string> xml = ReadText(annotation);
    if (!xml.ok()) return xml.status();
    StatusOr<VocImage> image = ParseVocAnnotation(*xml, annotation.string(), classes);
    if (!image.ok()) return image.status();
    image->id = id;
    image->file = root / "JPEGImages" / (id + ".jpg");
    if (!std::filesystem::exists(image->file))
      return Status::Error(image->file.string() + ": is missing");
    images.push_back(*std::move(image));
  }
  if (images.empty()) return Status::Error(list_file.string() + ": the set is empty");
  return images;
}

}  // namespace msf
