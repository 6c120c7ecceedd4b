// Bags that Foxglove's libraries write, read by mosbench: neither knows the other's code.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { parse } from "@foxglove/rosmsg";
import { MessageWriter } from "@foxglove/rosmsg2-serialization";
import { McapWriter, TempBuffer } from "@mcap/core";

const START_S = 1700000000;
const POINTS = [[1, 2, 3, 4], [-5.5, 6.25, 7, 0], [8, 9, 10, 255]];
const HEADER = "MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n";
const RULE = "=".repeat(80) + "\n";
const CLOUD =
  "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n" +
  "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n" +
  RULE + HEADER + RULE +
  "MSG: sensor_msgs/PointField\nstring name\nuint32 offset\nuint8 datatype\nuint32 count\n";
const TF =
  "geometry_msgs/TransformStamped[] transforms\n" + RULE +
  "MSG: geometry_msgs/TransformStamped\nstd_msgs/Header header\nstring child_frame_id\n" +
  "geometry_msgs/Transform transform\n" + RULE + HEADER + RULE +
  "MSG: geometry_msgs/Transform\ngeometry_msgs/Vector3 translation\n" +
  "geometry_msgs/Quaternion rotation\n" + RULE +
  "MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n" + RULE +
  "MSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";

function cloud(k) {
  const data = new Float32Array(POINTS.flatMap(([x, y, z, i]) => [x + k, y, z, i]));
  return {
    header: { stamp: { sec: START_S, nanosec: k * 1e8 }, frame_id: "lidar" },
    height: 1,
    width: POINTS.length,
    fields: ["x", "y", "z", "intensity"].map((name, i) => ({
      name, offset: 4 * i, datatype: 7, count: 1,
    })),
    is_bigendian: false,
    point_step: 16,
    row_step: 16 * POINTS.length,
    data: new Uint8Array(data.buffer),
    is_dense: true,
  };
}

const tf = (k) => ({
  transforms: [{
    header: { stamp: { sec: START_S, nanosec: k * 1e8 }, frame_id: "map" },
    child_frame_id: "lidar",
    transform: { translation: { x: k, y: 0, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 } },
  }],
});

async function bag(options) {
  const buffer = new TempBuffer();
  const writer = new McapWriter({ writable: buffer, ...options });
  await writer.start({ profile: "ros2", library: "test" });
  const topics = [["/points", "sensor_msgs/msg/PointCloud2", CLOUD, cloud],
                  ["/tf", "tf2_msgs/msg/TFMessage", TF, tf]];
  for (const topic of topics) {
    const schemaId = await writer.registerSchema({
      name: topic[1], encoding: "ros2msg", data: new TextEncoder().encode(topic[2]),
    });
    topic.id = await writer.registerChannel({
      topic: topic[0], schemaId, messageEncoding: "cdr", metadata: new Map(),
    });
    topic.writer = new MessageWriter(parse(topic[2], { ros2: true }));
  }
  for (let k = 0; k < 3; ++k) {
    for (const topic of topics) {
      const time = BigInt(START_S) * 1000000000n + BigInt(k) * 100000000n;
      await writer.addMessage({
        channelId: topic.id, sequence: k, logTime: time, publishTime: time,
        data: topic.writer.writeMessage(topic[3](k)),
      });
    }
  }
  await writer.end();
  return buffer.get();
}

for (const options of [{}, { useChunks: false }, { useMessageIndex: false }, { useSummaryOffsets: false,
  useStatistics: false, repeatSchemas: false, repeatChannels: false }, { chunkSize: 1 }]) {
  test(`a bag written with ${JSON.stringify(options)} gives its points and poses`, async () => {
    const folder = mkdtempSync(join(tmpdir(), "mosbench_ros2_"));
    try {
      const file = join(folder, "other.mcap");
      writeFileSync(file, await bag(options));
      const out = join(folder, "out");
      execFileSync(process.env.MOSBENCH_PROGRAM,
                   ["convert", file, "--layout", "semantickitti", "--out", out], { stdio: "pipe" });
      const sequence = join(out, "sequences", "other");
      for (let k = 0; k < 3; ++k) {
        const scan = readFileSync(join(sequence, "velodyne", `00000${k}.bin`));
        assert.deepEqual(new Uint8Array(scan), cloud(k).data);
      }
      const poses = readFileSync(join(sequence, "poses.txt"), "utf8").trim().split("\n");
      assert.deepEqual(poses.map((row) => Number(row.split(" ")[3])), [0, 1, 2]);
    } finally {
      rmSync(folder, { recursive: true });
    }
  });
}
