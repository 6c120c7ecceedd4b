#include "eval/store/product_record.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "datasets/disk/files.hpp"
#include "datasets/sequence/fingerprint.hpp"
#include "datasets/text/errors.hpp"
#include "datasets/text/json_text.hpp"
#include "eval/answer/answer_text.hpp"

namespace mosbench {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* kRecord = "products.json";

/// The hashes by file of an earlier run, none where there was none.
ordered_json read_hashes(const fs::path& file) {
  if (!is_there(file)) return ordered_json::object();
  const ordered_json json = parse_json(read_file(file), file);
  const auto files = json.is_object() ? json.find("files") : json.end();
  const bool fits = json.is_object() && files != json.end() && files->is_object() &&
                    std::ranges::all_of(*files, &ordered_json::is_string);
  if (fits) return *files;
  throw DataError(file, "has no hashes by file", "it as `mosbench run --write` wrote it, or none");
}

}  // namespace

ProductRecord::ProductRecord(fs::path folder)
    : folder_(std::move(folder)), hashes_(read_hashes(folder_ / kRecord)) {}

bool ProductRecord::has(const std::string& file) const {
  const auto hash = hashes_.find(file);
  if (hash == hashes_.end() || !is_there(folder_ / file)) return false;
  if (*hash == hash_of_text(read_file(folder_ / file))) return true;
  throw UsageError(fmt::format(
      "{}: was changed after the run, expected what --write made of its labels; remove it, and the "
      "same command makes it again",
      (folder_ / file).string()));
}

void ProductRecord::write(const std::string& file, std::string_view bytes) {
  constexpr std::size_t kUnsaved = 50;
  write_file_atomic(folder_ / file, bytes);
  hashes_[file] = hash_of_text(bytes);
  if (++unsaved_ == kUnsaved) save();
}

void ProductRecord::save() {
  unsaved_ = 0;
  write_file_atomic(folder_ / kRecord, json_text({{"files", hashes_}}));
}

}  // namespace mosbench
