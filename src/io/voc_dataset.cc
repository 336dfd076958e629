#include "io/voc_dataset.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>
#include <pugixml.hpp>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/text_rows.h"

namespace msf {

namespace {

// Of pixels: beyond it, whole numbers are not exact.
constexpr double kLargestNumber = 1 << 24;

StatusOr<std::string> ReadText(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    return Status::Error(file.string() +
                         ": cannot be opened; is this a folder in PASCAL VOC layout?");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

// The number that an element holds, or nothing when it is missing or holds anything else.
std::optional<float> NumberIn(const pugi::xml_node& element) {
  constexpr std::string_view kBlanks = " \t\r\n";
  std::string_view text = element.child_value();
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  text = text.substr(0, text.find_last_not_of(kBlanks) + 1);
  const std::optional<double> number = ParseFiniteNumber(text);
  if (!number || std::abs(*number) > kLargestNumber) return std::nullopt;
  return static_cast<float>(*number);
}

Status ReadBox(const pugi::xml_node& box, const std::string& where, VocObject& object) {
  for (const auto& [side, value] : {std::pair("xmin", &object.x0), std::pair("ymin", &object.y0),
                                    std::pair("xmax", &object.x1), std::pair("ymax", &object.y1)}) {
    const std::optional<float> number = NumberIn(box.child(side));
    if (!number) {
      return Status::Error(where + " has " + side + " '" + box.child_value(side) +
                           "', which is no number of pixels");
    }
    *value = *number;
  }
  --object.x0;
  --object.y0;
  return Status::Ok();
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
  VocObject object;
  object.label = static_cast<int>(found - classes.begin());
  MSF_RETURN_IF_ERROR(ReadBox(node.child("bndbox"), origin + ": '" + name + "'", object));
  object.difficult = node.child("difficult").text().as_int() != 0;
  // One pixel of grace: rescaled annotations round, and some tools count from 0.
  const bool inside = object.x0 >= -1.0F && object.y0 >= -1.0F &&
                      object.x1 <= static_cast<float>(image.width) + 1.0F &&
                      object.y1 <= static_cast<float>(image.height) + 1.0F;
  const bool empty =
      !(std::min(object.x1, static_cast<float>(image.width)) > std::max(object.x0, 0.0F)) ||
      !(std::min(object.y1, static_cast<float>(image.height)) > std::max(object.y0, 0.0F));
  if (!inside || empty) {
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
  image.width = static_cast<int>(NumberIn(root.child("size").child("width")).value_or(0));
  image.height = static_cast<int>(NumberIn(root.child("size").child("height")).value_or(0));
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
    std::error_code ignored;
    if (!std::filesystem::exists(image->file, ignored))
      return Status::Error(image->file.string() + ": is missing");
    images.push_back(*std::move(image));
  }
  if (images.empty()) return Status::Error(list_file.string() + ": the set is empty");
  return images;
}

}  // namespace msf
