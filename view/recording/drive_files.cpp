#include "view/recording/drive_files.hpp"

#include <future>
#include <sstream>

#include "json/json.hpp"
#include "view/embedded.hpp"
#include "view/protocol/frame_writer.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/replay.hpp"

namespace slalom::view {
namespace {

Message file_message(const std::string& name, const std::string& content) {
  FrameWriter to;
  to.begin(Block::file);
  to.put(static_cast<std::uint32_t>(name.size()));
  to.append(name);
  to.pad();
  to.append(content);
  to.end();
  return {shared(to.take()), true};
}

template <class Writer>
void write(const StoredDrive& drive, Writer& to) {
  to.add_text(drive.hello);
  if (drive.scene) to.add_course(*drive.scene);
  to.add_text(drive.options);
  to.add_text(drive.state);
  for (const DrivenTick& tick : drive.ticks) to.add_frame(*tick.message({pack, unpack}));
  to.finish();
}

Message make_recording(const StoredDrive& drive, RecorderOptions files) {
  const Scanner scanner = drive.scanner.value_or(Scanner{});
  files.settings = {{"settings", json_text({{"command_line", drive.command_line}})}};
  files.lidar_angle_min = scanner.angle_min;
  files.lidar_angle_increment = scanner.angle_increment;
  std::ostringstream stream;
  Recorder recorder(stream, files);
  write(drive, recorder);
  return file_message(drive.name + ".mcap", std::move(stream).str());
}

}  // namespace

std::string replay_page(const StoredDrive& drive, bool everything) {
  std::vector<std::string> segments;
  ReplaySegments replay([&](std::string segment) { segments.push_back(std::move(segment)); }, everything);
  write(drive, replay);
  return replay_page(page_html(), segments);
}

void add_files(SessionOptions& options, const RecorderOptions& files) {
  options.packing = {pack, unpack};
  options.save = [files, writing = std::make_shared<std::future<void>>()](
                     const std::string& what, StoredDrive drive, std::function<void(Message)> send) {
    if (writing->valid() && writing->wait_for(std::chrono::seconds(0)) != std::future_status::ready)
      throw std::invalid_argument("the previous file is still being written");
    *writing = std::async(std::launch::async, [=, drive = std::move(drive)] {
      try {
        send(what == "replay" ? file_message(drive.name + ".html", replay_page(drive, files.everything))
                              : make_recording(drive, files));
      } catch (const std::exception& error) {
        send({shared(json_text({{"type", "error"}, {"message", error.what()}})), false});
      }
    });
  };
}

}  // namespace slalom::view
