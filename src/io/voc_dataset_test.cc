#include "io/voc_dataset.h"

#include <gtest/gtest.h>

#include <fstream>

namespace msf {
namespace {

const std::vector<std::string> kClasses = {"cat", "person"};

std::string Annotation(const std::string& name, int x0, int y0, int x1, int y1) {
  return "<annotation><filename>a.jpg</filename><size><width>100</width><height>50</"
         "height><depth>3</depth></size><object><name>" +
         name + "</name><difficult>1</difficult><bndbox><xmin>" + std::to_string(x0) +
         "</xmin><ymin>" + std::to_string(y0) + "</ymin><xmax>" + std::to_string(x1) +
         "</xmax><ymax>" + std::to_string(y1) + "</ymax></bndbox></object></annotation>";
}

TEST(VocAnnotationTest, PixelsCountFromZeroAndEndsLieOutside) {
  const StatusOr<VocImage> image =
      ParseVocAnnotation(Annotation("person", 1, 11, 10, 50), "a.xml", kClasses);
  ASSERT_TRUE(image.ok()) << image.message();
  ASSERT_EQ(image->objects.size(), 1U);
  const VocObject& object = image->objects[0];
  EXPECT_EQ(object.label, 1);
  EXPECT_EQ(object.x0, 0);
  EXPECT_EQ(object.y0, 10);
  EXPECT_EQ(object.x1, 10);
  EXPECT_EQ(object.y1, 50);
  EXPECT_TRUE(object.difficult);
}

TEST(VocAnnotationTest, BlanksAroundANumberDoNoHarm) {
  std::string xml = Annotation("person", 7, 1, 10, 10);
  xml.replace(xml.find(">7<") + 1, 1, "\n\t 7.5 ");
  const StatusOr<VocImage> image = ParseVocAnnotation(xml, "a.xml", kClasses);
  ASSERT_TRUE(image.ok()) << image.message();
  EXPECT_EQ(image->objects[0].x0, 6.5F);
}

TEST(VocAnnotationTest, MistakesAreNamed) {
  const auto message = [](const std::string& xml) {
    return ParseVocAnnotation(xml, "a.xml", kClasses).message();
  };
  EXPECT_NE(message(Annotation("person", 50, 10, 120, 20)).find("outside the 100x50 image"),
            std::string::npos);
  EXPECT_NE(message(Annotation("person", 50, 10, 40, 20)).find("empty"), std::string::npos);
  EXPECT_NE(
      message(Annotation("zebra", 1, 1, 10, 10)).find("'zebra' is none of the model's 2 classes"),
      std::string::npos);
  for (const char* x0 : {"abc", "", "1O", "nan", "1e300", "12 px"}) {
    std::string xml = Annotation("person", 7, 1, 10, 10);
    xml.replace(xml.find(">7<") + 1, 1, x0);
    EXPECT_NE(message(xml).find(std::string("a.xml: 'person' has xmin '") + x0 + "'"),
              std::string::npos)
        << message(xml);
  }
  EXPECT_NE(message("<annotation><size><width>1O0</width><height>50</height></size></annotation>")
                .find("no image size"),
            std::string::npos);
  EXPECT_NE(message("<annotation><size>").find("a.xml: no XML"), std::string::npos);
  EXPECT_NE(message("<annotation></annotation>").find("no image size"), std::string::npos);
  EXPECT_NE(message("").find("a.xml"), std::string::npos);
}

class VocSetTest : public testing::Test {
 protected:
  void SetUp() override {
    root_ = std::filesystem::path(testing::TempDir()) / "voc";
    std::filesystem::remove_all(root_);
    for (const char* folder : {"Annotations", "JPEGImages", "ImageSets/Main"})
      std::filesystem::create_directories(root_ / folder);
  }
  void Write(const std::string& path, const std::string& text) {
    std::ofstream(root_ / path) << text;
  }

  std::filesystem::path root_;
};

TEST_F(VocSetTest, ReadsTheImagesOfASet) {
  Write("ImageSets/Main/trainval.txt", "b\na\n");
  Write("ImageSets/Main/test.txt", "a\n");
  for (const char* id : {"a", "b"}) {
    Write(std::string("Annotations/") + id + ".xml", Annotation("cat", 1, 1, 10, 10));
    Write(std::string("JPEGImages/") + id + ".jpg", "");
  }
  const StatusOr<std::vector<VocImage>> images = LoadVocSet(root_.string(), kClasses);
  ASSERT_TRUE(images.ok()) << images.message();
  ASSERT_EQ(images->size(), 2U);
  EXPECT_EQ((*images)[0].id, "b");
  EXPECT_EQ((*images)[1].file, root_ / "JPEGImages" / "a.jpg");
  EXPECT_EQ(LoadVocSet(root_.string() + ":test", kClasses)->size(), 1U);
}

TEST_F(VocSetTest, WhatIsMissingIsNamed) {
  EXPECT_NE(LoadVocSet(root_.string(), kClasses).message().find("trainval.txt"), std::string::npos);
  Write("ImageSets/Main/trainval.txt", "");
  EXPECT_NE(LoadVocSet(root_.string(), kClasses).message().find("the set is empty"),
            std::string::npos);
  Write("ImageSets/Main/trainval.txt", "a\n");
  EXPECT_NE(LoadVocSet(root_.string(), kClasses).message().find("a.xml"), std::string::npos);
  Write("Annotations/a.xml", Annotation("cat", 1, 1, 10, 10));
  EXPECT_NE(LoadVocSet(root_.string(), kClasses).message().find("a.jpg: is missing"),
            std::string::npos);
}

}  // namespace
}  // namespace msf
