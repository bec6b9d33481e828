# SPDX-License-Identifier: MIT
"""An Enhanced US Volume of the findings, whole by the standard (PS3.3 A.59; dciodvfy of dicom3tools finds no error in it): 12 x 10 pixels of
0.5 x 0.4 mm, planes 0.8 mm apart."""

from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian, generate_uid

STEP, SPACING = 0.8, [0.4, 0.5]
STORAGE = "1.2.840.10008.5.1.4.1.1.6.2"


def of(**fields):
    made = Dataset()
    for name, value in fields.items():
        setattr(made, name, value)
    return made


def code(value, scheme, meaning):
    return [of(CodeValue=value, CodingSchemeDesignator=scheme, CodeMeaning=meaning)]


def enhanced_volume(planes, times, value):
    """`planes` slices at each of `times`, time by time; the voxels of a slice are all `value(time, plane)`."""
    rows, columns, when, organized = 10, 12, "20200101120000", generate_uid()
    where = [(t, z) for t in range(times) for z in range(planes)]
    d = of(SOPClassUID=STORAGE, SOPInstanceUID=generate_uid(), StudyInstanceUID=generate_uid(), SeriesInstanceUID=generate_uid())
    d.file_meta = FileMetaDataset()
    d.file_meta.TransferSyntaxUID, d.file_meta.MediaStorageSOPClassUID = ExplicitVRLittleEndian, STORAGE
    d.file_meta.MediaStorageSOPInstanceUID = d.SOPInstanceUID
    d.PatientName, d.PatientID, d.PatientBirthDate, d.PatientSex, d.ReferringPhysicianName, d.AccessionNumber = "Phantom", "1", "", "", "", ""
    d.StudyDate = d.ContentDate = when[:8]
    d.StudyTime = d.ContentTime = when[8:]
    d.AcquisitionDateTime, d.AcquisitionDuration, d.StudyID, d.SeriesNumber, d.InstanceNumber = when, 1.0, "1", 1, 1
    d.Modality, d.Manufacturer, d.ManufacturerModelName, d.DeviceSerialNumber, d.SoftwareVersions = "US", "none", "phantom", "1", "1"
    d.FrameOfReferenceUID, d.PositionReferenceIndicator, d.VolumeFrameOfReferenceUID = generate_uid(), "", generate_uid()
    d.SynchronizationFrameOfReferenceUID, d.SynchronizationTrigger, d.AcquisitionTimeSynchronized = generate_uid(), "NO TRIGGER", "N"
    d.UltrasoundAcquisitionGeometry, d.ApexPosition, d.Laterality = "APEX", [3.0, -40.0, 2.0], ""
    d.VolumeToTransducerMappingMatrix = [float(i % 5 == 0) for i in range(16)]
    d.ImageType, d.DimensionOrganizationType = ["ORIGINAL", "PRIMARY", "VOLUME", "NONE"], "3D_TEMPORAL" if times > 1 else "3D"
    d.LossyImageCompression, d.PresentationLUTShape, d.BurnedInAnnotation, d.RescaleIntercept, d.RescaleSlope = "00", "IDENTITY", "NO", 0, 1
    d.MechanicalIndex = d.BoneThermalIndex = d.CranialThermalIndex = d.SoftTissueThermalIndex = 0.5
    d.DepthsOfFocus, d.DepthOfScanField, d.AcquisitionContextSequence, d.PatientOrientation = 60.0, 120, [], ["L", "P"]
    d.ViewCodeSequence = code("399214001", "SCT", "apical")
    d.ViewCodeSequence[0].ViewModifierCodeSequence = []
    d.AnatomicRegionSequence = code("17214001", "SCT", "fetus")
    d.TransducerScanPatternCodeSequence = code("125241", "DCM", "Volume scan pattern")
    d.TransducerGeometryCodeSequence = code("125252", "DCM", "Curved linear ultrasound transducer geometry")
    d.TransducerBeamSteeringCodeSequence = code("125254", "DCM", "Mechanical beam steering")
    d.TransducerApplicationCodeSequence = code("125261", "DCM", "External Transducer")
    d.DimensionOrganizationSequence = [of(DimensionOrganizationUID=organized)]
    time_and_place = (0x0020930D, 0x00209310), (0x00209301, 0x0020930E)  # Temporal Position Time Offset, Image Position (Volume)
    d.DimensionIndexSequence = [
        of(DimensionIndexPointer=pointer, FunctionalGroupPointer=group, DimensionOrganizationUID=organized) for pointer, group in time_and_place
    ]
    image = of(FrameType=d.ImageType, VolumetricProperties="VOLUME", VolumeBasedCalculationTechnique="NONE")
    shared = of(
        PixelMeasuresSequence=[of(PixelSpacing=SPACING, SliceThickness=STEP, SpacingBetweenSlices=STEP)],
        PlaneOrientationVolumeSequence=[of(ImageOrientationVolume=[1, 0, 0, 0, 1, 0])],
        FrameVOILUTSequence=[of(WindowCenter=127, WindowWidth=256)],
        ImageDataTypeSequence=[of(DataType="TISSUE_INTENSITY", AliasedDataType="NO", ZeroVelocityPixelValue=0)],
        USImageDescriptionSequence=[image],
    )
    d.SharedFunctionalGroupsSequence = [shared]
    d.PerFrameFunctionalGroupsSequence = [
        of(
            FrameContentSequence=[
                of(DimensionIndexValues=[t + 1, z + 1], FrameAcquisitionDateTime=when, FrameReferenceDateTime=when, FrameAcquisitionDuration=1.0)
            ],
            PlanePositionVolumeSequence=[of(ImagePositionVolume=[0, 0, STEP * z])],
            TemporalPositionSequence=[of(TemporalPositionTimeOffset=0.04 * t)],
        )
        for t, z in where
    ]
    d.NumberOfFrames, d.Rows, d.Columns, d.SamplesPerPixel, d.PhotometricInterpretation = len(where), rows, columns, 1, "MONOCHROME2"
    d.BitsAllocated = d.BitsStored = 8
    d.HighBit, d.PixelRepresentation = 7, 0
    d.PixelData = b"".join(bytes([value(t, z)]) * (rows * columns) for t, z in where)
    return d
