// SPDX-License-Identifier: MIT
// A client on libOpenIGTLink: sends a volume of skin, fluid and fetus, checks what comes back, and prints it.
// Usage: igtl_client PORT SIDE. Exit code 1: what came back is not what must come.
#include "igtlClientSocket.h"
#include "igtlImageMessage.h"
#include "igtlMessageHeader.h"
#include "igtlStringMessage.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

static int fail(const char *what) {
    std::fprintf(stderr, "igtl_client: %s\n", what);
    return 1;
}

static igtl::ImageMessage::Pointer make_volume(int side) {
    igtl::ImageMessage::Pointer image = igtl::ImageMessage::New();
    image->SetDimensions(side, side, side);
    image->SetSpacing(0.5f, 0.5f, 0.75f);
    image->SetScalarTypeToUint8();
    image->SetDeviceName("Scan");
    image->SetSubVolume(side, side, side, 0, 0, 0);
    image->AllocateScalars();
    auto *voxels = static_cast<unsigned char *>(image->GetScalarPointer());
    for (int z = 0; z < side; z++)
        std::memset(voxels + z * side * side,
                    z < side / 5       ? 100
                    : z < 3 * side / 5 ? 10
                                       : 200,
                    static_cast<size_t>(side) * side);
    igtl::Matrix4x4 matrix;
    igtl::IdentityMatrix(matrix);
    matrix[0][3] = 11.0f;
    matrix[1][3] = 22.0f;
    matrix[2][3] = 33.0f;
    image->SetMatrix(matrix);
    image->Pack();
    return image;
}

// The library's Receive may come back with the part that has arrived.
static bool receive_all(igtl::ClientSocket *socket, void *to, igtlUint64 bytes) {
    auto *at = static_cast<char *>(to);
    bool timed_out = false;
    while (bytes > 0) {
        const igtlUint64 got = socket->Receive(at, bytes, timed_out);
        if (got == 0 || got > bytes) return false;
        at += got;
        bytes -= got;
    }
    return true;
}

static bool receive(igtl::ClientSocket *socket, igtl::MessageHeader::Pointer &header) {
    header = igtl::MessageHeader::New();
    header->InitPack();
    if (!receive_all(socket, header->GetPackPointer(), header->GetPackSize())) return false;
    header->Unpack();
    return true;
}

template <class Message>
static typename Message::Pointer body(igtl::ClientSocket *socket, igtl::MessageHeader *header) {
    typename Message::Pointer message = Message::New();
    message->SetMessageHeader(header);
    message->AllocatePack();
    if (!receive_all(socket, message->GetPackBodyPointer(), message->GetPackBodySize())) return nullptr;
    if (!(message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY)) return nullptr; // 1: with its checksum
    return message;
}

static int check_clipped(igtl::ImageMessage *image, int side) {
    int size[3];
    float spacing[3];
    igtl::Matrix4x4 matrix;
    image->GetDimensions(size);
    image->GetSpacing(spacing);
    image->GetMatrix(matrix);
    if (size[0] != side || size[1] != side || size[2] != side)
        return fail("the clipped volume has another size");
    if (std::fabs(spacing[0] - 0.5f) > 1e-5f || std::fabs(spacing[2] - 0.75f) > 1e-5f)
        return fail("another spacing");
    if (std::fabs(matrix[0][3] - 11.0f) > 1e-3f || std::fabs(matrix[2][3] - 33.0f) > 1e-3f)
        return fail("another place");
    const auto *voxels = static_cast<unsigned char *>(image->GetScalarPointer());
    const size_t middle = static_cast<size_t>(side) * side / 2 + static_cast<size_t>(side) / 2;
    if (voxels[middle] != 0) return fail("the skin is still there");
    if (voxels[middle + static_cast<size_t>(side) * side * (static_cast<size_t>(side) - 1)] != 200)
        return fail("the fetus is gone");
    return 0;
}

int main(int argc, char **argv) {
    if (argc != 3) return fail("usage: igtl_client PORT SIDE");
    const int side = std::atoi(argv[2]);
    igtl::ClientSocket::Pointer socket = igtl::ClientSocket::New();
    if (socket->ConnectToServer("127.0.0.1", std::atoi(argv[1])) != 0) return fail("no connection");
    igtl::StringMessage::Pointer parameters = igtl::StringMessage::New();
    parameters->SetDeviceName("Knob");
    parameters->SetString("method=wall q=0.5");
    parameters->Pack();
    socket->Send(parameters->GetPackPointer(), parameters->GetPackSize());
    igtl::ImageMessage::Pointer volume = make_volume(side);
    socket->Send(volume->GetPackPointer(), volume->GetPackSize());

    for (int n = 0; n < 4; n++) {
        igtl::MessageHeader::Pointer header;
        if (!receive(socket, header)) return fail("the server went away");
        const std::string name = header->GetDeviceName(), type = header->GetDeviceType();
        if (type == "STRING") {
            igtl::StringMessage::Pointer text = body<igtl::StringMessage>(socket, header);
            if (!text) return fail("a STRING in part or with a wrong checksum");
            std::printf("%s %s\n", name.c_str(), text->GetString());
            continue;
        }
        igtl::ImageMessage::Pointer image = body<igtl::ImageMessage>(socket, header);
        if (!image) return fail("an IMAGE in part or with a wrong checksum");
        if (name == "Scan_clipped" && check_clipped(image, side)) return 1;
        if (name == "Scan_depth") {
            const auto *depth = static_cast<float *>(image->GetScalarPointer());
            int size[3]; // the map has the machine's grid
            image->GetDimensions(size);
            std::printf("%s %.3f\n", name.c_str(),
                        static_cast<double>(depth[size[1] / 2 * size[0] + size[0] / 2]));
        } else {
            std::printf("%s\n", name.c_str());
        }
    }
    socket->CloseSocket();
    return 0;
}
