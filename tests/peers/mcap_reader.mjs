// Reads an MCAP file with the JavaScript reader of the format, as viewers do: prints what it counted.
import { open } from "node:fs/promises";
import { createRequire } from "node:module";

const require = createRequire(`${process.argv[2]}/`);
const { McapIndexedReader } = require("@mcap/core");
const { FileHandleReadable } = require("@mcap/nodejs");
const { loadDecompressHandlers } = require("@mcap/support");

const readable = new FileHandleReadable(await open(process.argv[3], "r"));
const reader = await McapIndexedReader.Initialize({
  readable,
  decompressHandlers: await loadDecompressHandlers(),
});
const counted = { messages: 0, channels: reader.channelsById.size, attachments: [], metadata: {} };
for await (const message of reader.readMessages()) {
  JSON.parse(Buffer.from(message.data).toString("utf8"));
  counted.messages += 1;
}
for await (const attachment of reader.readAttachments()) {
  counted.attachments.push([attachment.name, attachment.data.byteLength]);
}
for await (const metadata of reader.readMetadata()) {
  counted.metadata[metadata.name] = Object.fromEntries(metadata.metadata);
}
console.log(JSON.stringify(counted));
