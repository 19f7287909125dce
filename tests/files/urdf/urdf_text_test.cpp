#include "kinecal/files/urdf/urdf_text.ipp"

#include <gtest/gtest.h>

#include <string>

namespace kinecal {
namespace {

TEST(UrdfText, JointsAreFoundByTheirNamesAmongTheRobotsOwn) {
  const detail::UrdfText source("<robot><a><joint name='k'/></a>\n<joint name='j'/></robot>",
                                "r.urdf");
  EXPECT_EQ(source.place(source.joint("j")).str(), "r.urdf:2");
  EXPECT_FALSE(source.joint("k"));
}

TEST(UrdfText, AMessageIsPlacedByTheFirstJointItNamesOrElseTheFirstLink) {
  const detail::UrdfText source("<robot name='r'>\n<link name='a'/>\n<joint name='j'/>\n</robot>",
                                "r.urdf");
  EXPECT_EQ(source.place_of_name_in("link 'a' of joint 'j'").line, 3);
  EXPECT_EQ(source.place_of_name_in("two roots [a] and [b]").line, 2);
  EXPECT_EQ(source.place_of_name_in("1' of joint [j]").line, 3);
  EXPECT_EQ(source.place_of_name_in("no name at all").line, 0);
}

}  // namespace
}  // namespace kinecal
