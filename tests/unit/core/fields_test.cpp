#include "core/base/fields.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace mosbench::leaflets {
namespace {

enum class Shade { kDark, kLight };
inline constexpr std::array<std::string_view, 2> kShadeNames = {"dark", "light"};

struct Leaflet {
  bool folded = false;
  std::string title = "none";
  Shade shade = Shade::kLight;
  int pages = 4;
  std::optional<int> copies;
  std::optional<Shade> back;
};

template <typename AnyLeaflet, typename Visitor>
void visit_fields(AnyLeaflet& leaflet, Visitor&& visit) {
  visit("folded", leaflet.folded, kOffOn, "whether it is folded");
  visit("title", leaflet.title, AnyText{}, "what is on top");
  visit("shade", leaflet.shade, kShadeNames, "of the front");
  visit("pages", leaflet.pages, FieldRange{1, 64}, "how many");
  visit("copies", leaflet.copies, FieldRange{1, 9, "pages"}, "as many as pages when not set");
  visit("back", leaflet.back, kShadeNames, "of the back");
}

TEST(Fields, OfEachTypeComeBackAsTheyWereSet) {
  Settings settings = settings_of(Leaflet{});
  settings.set("folded", "on");
  settings.set("title", "to all");
  settings.set("copies", 3);
  settings.set("back", "dark");
  const auto leaflet = config_of<Leaflet>(settings);
  EXPECT_TRUE(leaflet.folded);
  EXPECT_EQ(leaflet.title, "to all");
  EXPECT_EQ(leaflet.shade, Shade::kLight);
  EXPECT_EQ(leaflet.pages, 4);
  EXPECT_EQ(leaflet.copies, 3);
  EXPECT_EQ(leaflet.back, Shade::kDark);
}

TEST(Fields, ThatAreNotSetStayUnsetAndFollowAnother) {
  const Settings settings = settings_of(Leaflet{});
  EXPECT_EQ(settings.whole("copies"), 4);
  const auto leaflet = config_of<Leaflet>(settings);
  EXPECT_FALSE(leaflet.copies.has_value());
  EXPECT_FALSE(leaflet.back.has_value());
}

TEST(Fields, RefuseWhatIsNotLegal) {
  Settings settings = settings_of(Leaflet{});
  EXPECT_THROW(settings.set("folded", "maybe"), std::invalid_argument);
  EXPECT_THROW(settings.set("title", 3), std::invalid_argument);
  EXPECT_THROW(settings.set("copies", 10), std::invalid_argument);
  EXPECT_THROW(settings.set("back", "grey"), std::invalid_argument);
}

}  // namespace
}  // namespace mosbench::leaflets
