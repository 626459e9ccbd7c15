import unittest

from loading import load

check_eds = load("check_eds")

HEAD = """[FileInfo]
FileName=drive.eds
FileVersion=1
FileRevision=1
EDSVersion=4.0
Description=a drive
CreationTime=08:00AM
CreationDate=01-02-2026
CreatedBy=Stator
ModificationTime=08:00AM
ModificationDate=01-02-2026
ModifiedBy=Stator

[DeviceInfo]
VendorName=Maker
VendorNumber=0x286
ProductName=Drive
ProductNumber=1
RevisionNumber=2
OrderCode=D1
{rates}
SimpleBootUpMaster=0
SimpleBootUpSlave=1
Granularity=8
DynamicChannelsSupported=0
GroupMessaging=0
NrOfRXPDO=1
NrOfTXPDO=0
LSS_Supported=0

[DummyUsage]
{dummies}

[Comments]
Lines=0

""".format(
    rates="\n".join(f"{key}=1" for key in check_eds.BIT_RATES),
    dummies="\n".join(f"{key}=0" for key in check_eds.DUMMIES),
)


def entry(section, name, data_type, access, default=None, mapping=0, extra=""):
    default = "" if default is None else f"DefaultValue={default}\n"
    return (
        f"[{section}]\nParameterName={name}\nObjectType=0x7\nDataType={data_type}\n"
        f"AccessType={access}\n{default}PDOMapping={mapping}\n{extra}\n"
    )


def record(section, name, count):
    return f"[{section}]\nParameterName={name}\nObjectType=0x9\nSubNumber={count}\n\n"


SOUND = (
    HEAD
    + "[MandatoryObjects]\nSupportedObjects=3\n1=0x1000\n2=0x1001\n3=0x1018\n\n"
    + entry("1000", "Device type", "0x0007", "ro", "0x192")
    + entry("1001", "Error register", "0x0005", "ro")
    + record("1018", "Identity", 4)
    + entry("1018sub0", "Entries", "0x0005", "const", 3)
    + entry("1018sub1", "Vendor", "0x0007", "ro", "0x286")
    + entry("1018sub2", "Product", "0x0007", "ro", 1)
    + entry("1018sub3", "Revision", "0x0007", "ro", 2)
    + "[OptionalObjects]\nSupportedObjects=3\n1=0x1400\n2=0x1600\n3=0x6040\n\n"
    + record("1400", "RPDO 1", 2)
    + entry("1400sub0", "Entries", "0x0005", "ro", 1)
    + entry("1400sub1", "COB-ID", "0x0007", "rw", "$NODEID+0x200")
    + record("1600", "RPDO 1 mapping", 2)
    + entry("1600sub0", "Entries", "0x0005", "rw", 1)
    + entry("1600sub1", "Entry 1", "0x0007", "rw", "0x60400010")
    + entry("6040", "Controlword", "0x0006", "rww", 0, 1)
    + "[ManufacturerObjects]\nSupportedObjects=1\n1=0x2000\n\n"
    + entry("2000", "Gain", "0x0003", "rw", -5, 0, "LowLimit=-10\nHighLimit=10\n")
)


def judged(text):
    return check_eds.check(text.replace("\n", "\r\n").encode("ascii"))


class CheckEds(unittest.TestCase):
    def test_a_sound_sheet_passes(self):
        self.assertEqual(judged(SOUND), ([], []))

    def test_mistakes_are_errors(self):
        for before, after, message in (
            ("NrOfRXPDO=1", "NrOfRXPDO=2", "NrOfRXPDO is not 1"),
            ("VendorNumber=0x286", "VendorNumber=0x287", "VendorNumber is not the default"),
            ("VendorNumber=0x286\n", "", "VendorNumber is missing"),
            ("VendorNumber=0x286", "VendorNumber=maker", "is not a number"),
            ("CreationDate=01-02-2026", "CreationDate=2026-01-02", "is not mm-dd-yyyy"),
            ("CreationTime=08:00AM", "CreationTime=20:00", "is not hh:mmAM"),
            ("3=0x1018", "3=0x1019", "does not belong into this list"),
            ("1=0x2000", "1=0x2001", "listed and not described"),
            ("AccessType=rww", "AccessType=rx", "AccessType=rx is unknown"),
            ("AccessType=rww", "AccessType=rwr", "cannot be mapped so"),
            ("DataType=0x0006", "DataType=0x0007", "maps 60400010h with a wrong length"),
            ("DefaultValue=-5", "DefaultValue=-11", "outside its limits"),
            ("LowLimit=-10", "LowLimit=11", "LowLimit 11 is above"),
            ("HighLimit=10", "HighLimit=40000", "no value of its data type"),
            ("0x60400010", "0x60410010", "which does not exist"),
            ("DefaultValue=3\n", "DefaultValue=4\n", "subindex 0 says 4, the highest is 3"),
            ("SubNumber=4", "SubNumber=3", "but 4 subindices are described"),
            (
                "[1001]\nParameterName=Error register\nObjectType=0x7\nDataType=0x0005",
                "[1001]\nParameterName=Error register\nObjectType=0x7\nDataType=0x0006",
                "CiA 301 has DataType=0x0005 here",
            ),
            ("$NODEID+0x200", "0x20000200", "outside of an 11-bit one"),
        ):
            with self.subTest(after):
                self.assertIn(before, SOUND)
                errors, _ = judged(SOUND.replace(before, after, 1))
                self.assertTrue(any(message in error for error in errors), errors)

    def test_what_confuses_masters_is_a_warning(self):
        for before, after, message in (
            ("AccessType=rww", "AccessType=rw", "mappable in both directions"),
            ("ParameterName=Gain", "ParameterName=Controlword", "two objects are called"),
            ("FileVersion=1\n", "FileVersion=1\nLastEDS=\n", "is no key of CiA 306-1"),
            ("DefaultValue=-5", "DefaultValue=", "has no value"),
        ):
            with self.subTest(after):
                _, warnings = judged(SOUND.replace(before, after, 1))
                self.assertTrue(any(message in warning for warning in warnings), warnings)

    def test_lines_end_with_cr_lf(self):
        errors, _ = check_eds.check(SOUND.encode("ascii"))
        self.assertTrue(any("CR LF" in error for error in errors))


if __name__ == "__main__":
    unittest.main()
