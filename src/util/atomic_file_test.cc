#include "util/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <thread>

namespace msf {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class AtomicFilePlaces : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "real");
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string Read(const fs::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  const fs::path folder_ =
      fs::canonical(testing::TempDir()) / ("atomic_file_places_" + std::to_string(getpid()));
};

TEST_F(AtomicFilePlaces, ALinkStaysAndItsFileIsWritten) {
  std::ofstream(folder_ / "real/a.txt") << "old";
  fs::create_symlink("real/a.txt", folder_ / "link");
  fs::create_symlink("real/new.txt", folder_ / "to_nothing");
  fs::create_symlink("to_nothing", folder_ / "to_a_link");
  EXPECT_TRUE(WriteFileAtomically(folder_ / "link", "new").ok());
  EXPECT_TRUE(WriteFileAtomically(folder_ / "to_a_link", "made").ok());
  EXPECT_EQ(Read(folder_ / "real/a.txt"), "new");
  EXPECT_EQ(Read(folder_ / "real/new.txt"), "made");
  for (const char* link : {"link", "to_nothing", "to_a_link"})
    EXPECT_TRUE(fs::is_symlink(folder_ / link)) << link;
}

TEST_F(AtomicFilePlaces, PipesAndDevicesAreWrittenToAndStay) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = Read(pipe); });
  EXPECT_TRUE(WriteFileAtomically(pipe, "through").ok());
  reader.join();
  EXPECT_EQ(read, "through");
  EXPECT_TRUE(fs::is_fifo(pipe));

  EXPECT_TRUE(WriteFileAtomically("/dev/null", "away").ok());
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THAT(WriteFileAtomically("/dev/full", "too much").message(),
              HasSubstr("/dev/full: cannot be written: No space left"));
}

TEST_F(AtomicFilePlaces, WhatCannotBeWrittenIsNamedWithTheReason) {
  fs::create_symlink("circle", folder_ / "circle");
  EXPECT_THAT(WriteFileAtomically(folder_ / "circle", "x").message(),
              HasSubstr("circle: cannot be written: Too many levels"));
  EXPECT_THAT(WriteFileAtomically(folder_ / "real", "x").message(), HasSubstr("Is a directory"));
  EXPECT_THAT(WriteFileAtomically(folder_ / "no/a.txt", "x").message(), HasSubstr("No such file"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 2) << "nothing is left behind";
}

TEST_F(AtomicFilePlaces, AWriterThatGivesUpLeavesNothing) {
  const auto give_up = [](std::ostream& stream) {
    stream << "half";
    throw std::runtime_error("enough");
  };
  EXPECT_THROW((void)WriteFileAtomically(folder_ / "real/a.txt", give_up), std::runtime_error);
  EXPECT_TRUE(fs::is_empty(folder_ / "real"));
}

TEST_F(AtomicFilePlaces, StandardOutputGoesOnWhereItIs) {
  testing::internal::CaptureStdout();
  std::fputs("before ", stdout);
  std::fflush(stdout);
  EXPECT_TRUE(WriteFileAtomically("/dev/stdout", "inside ").ok());
  std::fputs("after", stdout);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "before inside after");
}

TEST_F(AtomicFilePlaces, NamesOfTheSamePlaceAreTheSamePath) {
  fs::create_directory_symlink("real", folder_ / "link");
  for (const char* name : {"real", "real/", "real/.", "link", "link/", "link/../real"})
    EXPECT_EQ(ResolvePath(folder_ / name), folder_ / "real") << name;
  for (const char* name : {"real/new", "real/new/", "link/new", "link/other/../new"})
    EXPECT_EQ(ResolvePath(folder_ / name), folder_ / "real/new") << name;
  EXPECT_EQ(ResolvePath("new"), fs::current_path() / "new");
  EXPECT_EQ(ResolvePath(""), "");
}

}  // namespace
}  // namespace msf
